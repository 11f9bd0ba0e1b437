package org.magcomp

import kotlin.math.abs
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Job
import kotlinx.coroutines.ensureActive
import org.magcomp.core.*

/**
 * A compensator with what surrounds it: a store, a declination, guidance. One thread at a time, but for [save].
 *
 * @param stores where the store is called, so that no reading waits for it
 */
internal class Estimation(
    config: CompensationConfig,
    store: CalibrationStore?,
    private val declinationDeg: () -> Double?,
    private val source: MagneticFieldSource,
    private val unixTimeS: () -> Long,
    stores: CoroutineScope,
) : EventTaker, AutoCloseable {
    val compensator = Compensator(config)
    private val buffer = ReadingBuffer()
    private val configFrame = config.headingFrame()
    private var currentFrame = configFrame

    /** What was taken over last. */
    private var text: String? = null

    /** Whether what was kept or given was not confirmed by live samples yet, and whether there is a calibration. */
    private var unconfirmed = config.initial != null
    private var isInForce = true

    /** When the latest run ended, seconds since 1970. */
    private var endedS: Long? = null
    private var hiddenS = source.hiddenS

    private val keeping = store?.let { Keeping<Correction>(it, stores) }

    /** The time of the sample at which it was saved last. */
    private var savedNs: Long? = null
    private val coverage = DoubleArray(FastPath.COVERAGE)
    private var unseen = emptyList<DeviceVector>()
    private var lookedNs: Long? = null
    private var latestNs = Long.MIN_VALUE
    private var begun = false
    private var vertical = Vertical()

    /** The latest sensors in use, where the source knows them, and what is told of them. */
    private var sensors: SensorsInUse? = null
    private var stream: StreamStatus = StreamStatus.Live
    private var around = Answer.Around(unseen, null, null, null, stream)

    /** Whether help from outside ever came, which few apps have: what it is worth is asked over the slow path. */
    @Volatile
    private var isAided = false
    private var headingAid: HeadingAid? = null

    /** The text that was loaded could not be taken over. */
    private var keptError: MagcompException? = null

    init {
        keeping?.load()
    }

    /** Who is told of this run, and the job that ends it. */
    private lateinit var to: Told
    private lateinit var job: Job

    /** Events of a new run follow: of a source whose times begin again, or of one that goes on. */
    fun begin(to: Told, job: Job) {
        this.to = to
        this.job = job
        begun = true
        sensors = null
        stream = StreamStatus.Live
        vertical = Vertical()
    }

    /** What the latest events have taught of turns and of the vertical is wrong. */
    override fun anotherClock() = renew(null)

    override fun take(event: RawEvent) {
        // of a source that never suspends this is the end
        job.ensureActive()
        if (begun) {
            begun = false
            // one that is only late is none of another clock
            if (latestNs != Long.MIN_VALUE && latestNs.toDouble() - event.timeNs.toDouble() > ANOTHER_CLOCK_NS) renew(endedS)
        }
        with(event) {
            when (kind) {
                RawEvent.ROTATION_RATE -> compensator.pushRotationRate(timeNs, x, y, z)
                RawEvent.UP -> {
                    compensator.pushUp(timeNs, x, y, z)
                    vertical.up(timeNs)
                }
                else -> to.tell(magnetic(this))
            }
        }
    }

    /** Help from outside, from any thread; whether it was taken. */
    fun aid(push: Compensator.() -> Boolean): Boolean = compensator.push().also { if (it) isAided = true }

    /**
     * Where the magnetometer is silent now, and this is news, this tells an answer to no sample: it has no field, no heading, no attitude. Of the
     * other sensors the next sample tells.
     */
    override fun heard(sensors: SensorsInUse) {
        val before = stream
        this.sensors = sensors
        stream = sensors.stream()
        if (!sensors.magnetometer.isSilent || stream == before) return
        val isFirst = latestNs == Long.MIN_VALUE
        val timeNs = if (isFirst) 0 else latestNs
        buffer.slots.fill(Double.NaN, 0, ReadingBuffer.SIGMA_T)
        for (slot in OF_SAMPLES) buffer.slots[slot] = Double.NaN
        buffer.slots[ReadingBuffer.MODEL_ORDER] = -1.0
        val reading = buffer.reading(timeNs, if (isFirst) null else buffer.event, NOTHING)
        to.tell(Answer(timeNs, NOTHING, reading.event, null, around(stream), Answer.Record(reading, MagneticSample(timeNs, NOWHERE))))
    }

    /** Waits until the store has done what it was asked for, no longer than so many milliseconds. */
    suspend fun settled(atMostMs: Long = Long.MAX_VALUE) {
        keeping?.settled(atMostMs)
    }

    private fun storeError(): Exception? = keptError ?: keeping?.error

    /** Takes over what the store has loaded, unless better was learned meanwhile. */
    private fun takeLoaded() {
        val kept = keeping?.takeLoaded() ?: return
        if (compensator.keep(unixTimeS()) != null) return
        try {
            adopt(kept)
            keeping.kept = correction()
        } catch (e: MagcompException) {
            // as at the first launch
            if (e !is MagcompException.KeptDamaged && e !is MagcompException.KeptNewer) throw e
            keptError = e
        }
    }

    private fun adopt(kept: String) {
        compensator.adoptKept(kept, unixTimeS())
        text = kept
        unconfirmed = true
    }

    /** Keeps the calibration alone, as old as the time since then makes it: all else belongs to the times before. */
    private fun renew(sinceS: Long?) {
        val kept = compensator.keep(sinceS ?: unixTimeS()) ?: text
        compensator.reset()
        currentFrame = configFrame
        kept?.let(::adopt)
        lookedNs = null
        headingAid = null
    }

    /** The phone slept, and the events' times do not show it. */
    private fun noteSleep() {
        val now = source.hiddenS
        if (now == hiddenS) return
        compensator.pushGap(now - hiddenS)
        hiddenS = now
    }

    private fun magnetic(sample: RawEvent): Answer {
        takeLoaded()
        val wantedDeg = declinationDeg()
        if (wantedDeg != currentFrame.declinationDeg) {
            currentFrame = configFrame.copy(declinationDeg = wantedDeg)
            compensator.setHeadingFrame(currentFrame)
        }
        noteSleep()
        val reported = sample.reportedHardIronUt?.takeIf { isBelieved() } ?: NOWHERE
        compensator.push(sample.timeNs, sample.x, sample.y, sample.z, reported.x, reported.y, reported.z, buffer)
        val status = buffer.status
        // a time that is refused may be any
        if (status !is CompensationStatus.Rejected) {
            isInForce = !buffer.xUt.isNaN()
            if (status == CompensationStatus.Tracking) unconfirmed = false
            nowAndThen(sample.timeNs, status)
            vertical.magnetic(sample.timeNs)
        }
        val isNowhere = buffer.attitudeW.isNaN()
        val told = if (stream == StreamStatus.Live && vertical.isMissing && isNowhere) StreamStatus.NoVertical else stream
        val numbers = if (isNowhere) null else buffer.slots.copyOfRange(ReadingBuffer.ATTITUDE, ReadingBuffer.ATTITUDE + NUMBERS)
        numbers?.let { System.arraycopy(buffer.slots, ReadingBuffer.POINTING, it, OF_ATTITUDE, NUMBERS - OF_ATTITUDE) }
        val record = if (to.isWholeWanted) recordOf(sample) else null
        return Answer(sample.timeNs, status, buffer.event, numbers, around(told), record)
    }

    private fun recordOf(sample: RawEvent) = with(sample) {
        Answer.Record(buffer.toReading(), MagneticSample(timeNs, DeviceVector(x, y, z), reportedHardIronUt))
    }

    /** What the answers have in common, the one of before where it is the same. */
    private fun around(told: StreamStatus): Answer.Around {
        val error = storeError()
        val isSame = with(around) {
            unseenDirections === unseen && sensors === this@Estimation.sensors && storeError === error && stream === told &&
                headingAid == this@Estimation.headingAid
        }
        if (!isSame) around = Answer.Around(unseen, sensors, error, headingAid, told)
        return around
    }

    /** Beside a calibration that was kept or given the system's hard iron is listened to only where the system itself is sure of it. */
    private fun isBelieved(): Boolean {
        val accuracy = sensors?.magnetometer?.accuracy
        return !(unconfirmed && isInForce) || accuracy == null || accuracy == SensorAccuracy.HIGH
    }

    private fun nowAndThen(timeNs: Long, status: CompensationStatus) {
        latestNs = timeNs
        val since = savedNs
        if (since == null && status == CompensationStatus.Tracking) {
            save()
            savedNs = timeNs
        }
        val looked = lookedNs
        if (looked == null || apart(timeNs, looked) >= LOOK_EVERY_NS) {
            lookedNs = timeNs
            unseen = unseenNow()
            if (isAided) headingAid = compensator.headingAid()
            if (since != null && apart(timeNs, since) >= SAVE_EVERY_NS && keeping?.isBusy == false && save()) savedNs = timeNs
        }
    }

    /** The list of before where it is the same, as it is nearly always. */
    private fun unseenNow(): List<DeviceVector> {
        val count = compensator.coverage(coverage)
        var isSame = count == unseen.size
        for (k in 0 until count) isSame = isSame && with(unseen[k]) { x == coverage[1 + 3 * k] && y == coverage[2 + 3 * k] && z == coverage[3 + 3 * k] }
        return if (isSame) unseen else List(count) { DeviceVector(coverage[1 + 3 * it], coverage[2 + 3 * it], coverage[3 + 3 * it]) }
    }

    /** Nanoseconds between two times; the clock may have begun anew between them, so either may be the later. */
    private fun apart(oneNs: Long, otherNs: Long): Double = abs(oneNs.toDouble() - otherNs.toDouble())

    /**
     * Has what was learned saved, where the store does not keep it already, from any thread. What the store throws is told with the
     * readings; the next save tries again.
     *
     * @return whether the store was asked to
     */
    @Synchronized
    fun save(): Boolean {
        if (keeping == null) return false
        val found = correction()
        if (found == null || keeping.kept?.let(found::isNear) == true) return false
        val kept = compensator.keep(unixTimeS()) ?: return false
        keptError = null
        keeping.save(kept, found)
        return true
    }

    private fun correction() = compensator.calibration()?.let(::Correction)

    /** What corrects a sample: of a calibration all but the field strength, which follows the noise of a device at rest. */
    private class Correction(of: MagnetometerCalibration) {
        private val softIron = of.softIron.run { listOf(xx, yy, zz, xy, xz, yz) }
        private val hardIronUt = of.hardIronUt.run { listOf(x, y, z) }

        /** Whether both correct a sample of the Earth's field to the same, as a phone's magnetometer resolves it; at rest it wanders by less. */
        fun isNear(other: Correction): Boolean = softIron.isNear(other.softIron, SAME_SOFT_IRON) && hardIronUt.isNear(other.hardIronUt, SAME_UT)

        private fun List<Double>.isNear(others: List<Double>, within: Double) = indices.all { abs(this[it] - others[it]) <= within }

        private companion object {
            /** A phone's magnetometer resolves 0.1 uT and more. */
            const val SAME_UT = 0.01

            /** About as much of a field of 50 uT. */
            const val SAME_SOFT_IRON = 0.0002
        }
    }

    /** Saves at the end of a run. */
    fun end() {
        endedS = unixTimeS()
        try {
            save()
        } catch (_: MagcompException) {
            // after a defect there is nothing to keep
        }
    }

    override fun close(): Unit = compensator.close()

    private companion object {
        /** About what a crash costs; flash memory wears out with more. */
        const val SAVE_EVERY_NS = 10_000_000_000L

        /** As often as an eye sees. */
        const val LOOK_EVERY_NS = 200_000_000L

        /** Events that are late come by less. */
        const val ANOTHER_CLOCK_NS = 1e9

        /** Of an answer's numbers, and those of them that are the attitude's. */
        const val NUMBERS = 9
        const val OF_ATTITUDE = 4

        /** What a reading of no sample says, and what it does not. */
        val NOTHING = CompensationStatus.Rejected(RejectReason.NotFinite)
        val NOWHERE = DeviceVector(Double.NaN, Double.NaN, Double.NaN)
        val OF_SAMPLES = intArrayOf(ReadingBuffer.SIGMA_T, ReadingBuffer.DIRECTION_SIGMA, ReadingBuffer.WORST_SIGMA, ReadingBuffer.REPORTED_JUMP)
    }
}

/** Whether samples have an event of `up` near their own time. */
private class Vertical {
    private var upNs = NEVER

    /** The latest sample that had one, or else the first of the run. */
    private var pairedNs = NEVER
    private var latestNs = NEVER

    fun up(timeNs: Long) {
        upNs = timeNs
    }

    fun magnetic(timeNs: Long) {
        latestNs = timeNs
        // also where the clock begins anew
        if (pairedNs == NEVER || timeNs < pairedNs || isNear(upNs, timeNs)) pairedNs = timeNs
    }

    /** For a second none had. */
    val isMissing: Boolean get() = pairedNs != NEVER && !isNear(pairedNs, latestNs)

    private fun isNear(oneNs: Long, otherNs: Long) = oneNs != NEVER && abs(oneNs.toDouble() - otherNs.toDouble()) <= A_SECOND_NS

    private companion object {
        const val NEVER = Long.MIN_VALUE
        const val A_SECOND_NS = 1e9
    }
}

/** What the sensors in use say of the stream. */
internal fun SensorsInUse.stream(): StreamStatus {
    val silent = buildSet {
        if (magnetometer.isSilent) add(PhoneSensor.MAGNETOMETER)
        if (gyroscope?.isSilent == true) add(PhoneSensor.GYROSCOPE)
        if (up?.isSilent == true) add(PhoneSensor.GRAVITY)
    }
    return if (silent.isEmpty()) StreamStatus.Live else StreamStatus.Silent(silent)
}

/** Seconds since 1970. */
internal fun systemUnixTimeS(): Long = System.currentTimeMillis() / 1000

/** The heading frame of a config; what was left out is the library's default. */
internal fun CompensationConfig.headingFrame(): HeadingFrame = HeadingFrame(
    heading?.axis ?: ReferenceAxis.AUTO,
    heading?.screenRotation ?: ScreenRotation.DEG0,
    heading?.declinationDeg,
)
