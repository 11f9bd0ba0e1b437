package org.magcomp

import kotlin.math.abs
import kotlinx.coroutines.flow.StateFlow

/** A compensator with what surrounds it: a store, a heading frame, guidance. One thread at a time, but for [save]. */
internal class Estimation(
    config: CompensationConfig,
    private val store: CalibrationStore?,
    private val frame: StateFlow<HeadingFrame>? = null,
    private val source: MagneticFieldSource? = null,
    private val unixTimeS: () -> Long = ::systemUnixTimeS,
) : AutoCloseable {
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
    private var hiddenS = source?.hiddenS ?: 0.0

    /** What the store keeps, and the time of the sample it was saved at. */
    private var saved: Correction? = null
    private var savedNs: Long? = null
    private val coverage = DoubleArray(FastPath.COVERAGE)
    private var unseen = emptyList<DeviceVector>()
    private var lookedNs: Long? = null
    private var latestNs = Long.MIN_VALUE
    private var begun = false

    /** Whether help from outside ever came, which few apps have: what it is worth is asked over the slow path. */
    @Volatile
    private var isAided = false
    private var headingAid: HeadingAid? = null

    @Volatile
    private var storeError: Exception? = null

    init {
        try {
            store?.load()?.let {
                adopt(it)
                saved = correction()
            }
        } catch (e: Exception) {
            // as at the first launch
            storeError = e
        }
    }

    /** Events of a new run follow: of a source whose times begin again, or of one that goes on. */
    fun begin() {
        begun = true
    }

    fun push(event: RawEvent): CompensatedReading? {
        if (begun) {
            begun = false
            if (event.timeNs < latestNs) renew()
        }
        with(event) {
            when (kind) {
                RawEvent.ROTATION_RATE -> compensator.pushRotationRate(timeNs, x, y, z)
                RawEvent.UP -> compensator.pushUp(timeNs, x, y, z)
                else -> return magnetic(this)
            }
        }
        return null
    }

    /** Help from outside, from any thread; whether it was taken. */
    fun aid(push: Compensator.() -> Boolean): Boolean = compensator.push().also { if (it) isAided = true }

    private fun adopt(kept: String) {
        compensator.adoptKept(kept, unixTimeS())
        text = kept
        unconfirmed = true
    }

    /** Keeps the calibration alone, as old as the time since the latest run makes it: all else belongs to the times before. */
    private fun renew() {
        val kept = compensator.keep(endedS ?: unixTimeS()) ?: text
        compensator.reset()
        currentFrame = configFrame
        kept?.let(::adopt)
        lookedNs = null
        headingAid = null
    }

    /** The phone slept, and the events' times do not show it. */
    private fun noteSleep() {
        val now = source?.hiddenS ?: return
        if (now == hiddenS) return
        compensator.pushGap(now - hiddenS)
        hiddenS = now
    }

    private fun magnetic(sample: RawEvent): CompensatedReading {
        val wanted = frame?.value
        if (wanted != null && wanted != currentFrame) {
            compensator.setHeadingFrame(wanted)
            currentFrame = wanted
        }
        noteSleep()
        val reported = sample.reported?.takeIf { isBelieved() }
        if (reported == null) {
            compensator.push(sample.timeNs, sample.x, sample.y, sample.z, buffer)
        } else {
            compensator.push(sample.timeNs, sample.x, sample.y, sample.z, reported.x, reported.y, reported.z, buffer)
        }
        val answer = Answer(buffer, sample)
        // a time that is refused may be any
        if (answer.status !is CompensationStatus.Rejected) {
            isInForce = !buffer.xUt.isNaN()
            if (answer.status == CompensationStatus.Tracking) unconfirmed = false
            nowAndThen(sample.timeNs, answer.status)
        }
        return CompensatedReading(answer, unseen, droppedBefore = 0, source?.sensors?.value, storeError, headingAid)
    }

    /** Beside a calibration that was kept or given the system's hard iron is listened to only where the system itself is sure of it. */
    private fun isBelieved(): Boolean {
        val accuracy = source?.sensors?.value?.magnetometer?.accuracy
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
            if (since != null && apart(timeNs, since) >= SAVE_EVERY_NS && save()) savedNs = timeNs
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
     * Saves what was learned and the store does not keep already, from any thread. What the store throws is told with the readings; the next
     * save tries again.
     *
     * @return whether the store was called
     */
    @Synchronized
    fun save(): Boolean {
        if (store == null) return false
        val found = correction()
        if (found == null || found == saved) return false
        val kept = compensator.keep(unixTimeS()) ?: return false
        try {
            store.save(kept)
            saved = found
            storeError = null
        } catch (e: Exception) {
            storeError = e
        }
        return true
    }

    private fun correction() = compensator.calibration()?.let { Correction(it.softIron, it.hardIronUt) }

    /** What corrects a sample: of a calibration all but the field strength, which follows the noise of a device at rest. */
    private data class Correction(val softIron: SoftIron, val hardIronUt: DeviceVector)

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
    }
}

/** Seconds since 1970. */
internal fun systemUnixTimeS(): Long = System.currentTimeMillis() / 1000

/** The heading frame of a config; what was left out is the library's default. */
internal fun CompensationConfig.headingFrame(): HeadingFrame = HeadingFrame(
    heading?.axis ?: ReferenceAxis.AUTO,
    heading?.screenRotation ?: ScreenRotation.DEG0,
    heading?.declinationDeg,
)
