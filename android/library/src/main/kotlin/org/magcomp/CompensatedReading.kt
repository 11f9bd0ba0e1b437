package org.magcomp

import kotlin.math.abs
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.channels.BufferOverflow
import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.coroutineScope
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.cancellable
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.launch

/**
 * The answer to one magnetometer sample, as collectors get it.
 *
 * @property reading corrected field, heading, and what the compensator is doing
 * @property sample the raw sample it answers
 * @property unseenDirections where the field has not pointed yet, unit vectors in the device frame: the app may ask its
 *   user to turn the phone so that it does. Renewed several times a second
 * @property droppedBefore readings dropped right before this one because the collector was slow; the estimator saw
 *   every sample all the same
 */
public data class CompensatedReading(
    public val reading: Reading,
    public val sample: MagneticSample,
    public val unseenDirections: List<Vector3>,
    public val droppedBefore: Long = 0,
)

/**
 * Compensates a stream of sensor events: one reading for every magnetometer sample.
 *
 * Every collector has its own [Compensator], fed on a background thread, so a slow collector never holds it up: between
 * them a buffer drops the oldest reading and counts it.
 *
 * @param config what was left out is the library's default
 * @param store where the calibration is kept from one launch to the next; null: nowhere
 * @param frame the heading frame in force at each moment; null: the config's
 * @param capacity readings kept for a slow collector, at least 1
 */
public fun Flow<SensorSample>.compensated(
    config: Config = Config(),
    store: CalibrationStore? = null,
    frame: StateFlow<HeadingFrame>? = null,
    capacity: Int = 64,
): Flow<CompensatedReading> {
    require(capacity >= 1) { "capacity is $capacity, expected at least 1" }
    val samples = this
    return flow {
        coroutineScope {
            val readings = Channel<Numbered>(capacity, BufferOverflow.DROP_OLDEST)
            launch(Dispatchers.Default) {
                val error = try {
                    Estimation(config, store, frame).use { estimation ->
                        samples.cancellable().collect { sample -> estimation.push(sample)?.let { readings.send(it) } }
                    }
                    null
                } catch (e: Exception) {
                    e
                }
                // after the readings that came before it, and even a CancellationException, such as a source's own timeout,
                // which would end this coroutine without a word
                readings.close(error)
            }
            var next = 0L
            for ((number, answer) in readings) {
                emit(if (number == next) answer else answer.copy(droppedBefore = number - next))
                next = number + 1
            }
        }
    }
}

private data class Numbered(val number: Long, val answer: CompensatedReading)

/** One collector's compensator. */
private class Estimation(config: Config, private val store: CalibrationStore?, private val frame: StateFlow<HeadingFrame>?) :
    AutoCloseable {
    private val compensator = Compensator(config)
    private val buffer = ReadingBuffer()
    private var number = 0L
    private var currentFrame: HeadingFrame? = frameOf(config)

    /** What the store keeps, and the time of the sample it was saved at. */
    private var saved: Correction? = null
    private var savedNs: Long? = null
    private var unseen = emptyList<Vector3>()
    private var lookedNs: Long? = null

    init {
        store?.load()?.let {
            try {
                compensator.restoreCalibration(it)
                saved = correction()
            } catch (_: MagcompException.SnapshotDamaged) {
                // as at the first launch
            } catch (_: MagcompException.SnapshotNewer) {
                // as at the first launch
            }
        }
    }

    fun push(event: SensorSample): Numbered? {
        when (event) {
            is SensorSample.Magnetic -> return push(event.sample)
            is SensorSample.RotationRate ->
                with(event.sample.rateRadS) { compensator.pushRotationRate(event.timeNs, x, y, z) }
            is SensorSample.Up -> with(event.sample.upMS2) { compensator.pushUp(event.timeNs, x, y, z) }
        }
        return null
    }

    private fun push(sample: MagneticSample): Numbered {
        val wanted = frame?.value
        if (wanted != null && wanted != currentFrame) {
            compensator.setHeadingFrame(wanted)
            currentFrame = wanted
        }
        val field = sample.fieldUt
        val reported = sample.reportedHardIronUt
        if (reported == null) {
            compensator.push(sample.timeNs, field.x, field.y, field.z, buffer)
        } else {
            compensator.push(sample.timeNs, field.x, field.y, field.z, reported.x, reported.y, reported.z, buffer)
        }
        val reading = buffer.toReading()
        // a time that is refused may be any
        if (reading.status !is Status.Rejected) nowAndThen(sample.timeNs, reading.status)
        return Numbered(number++, CompensatedReading(reading, sample, unseen))
    }

    private fun nowAndThen(timeNs: Long, status: Status) {
        val since = savedNs
        if (since == null && status == Status.Tracking) {
            save()
            savedNs = timeNs
        }
        val looked = lookedNs
        if (looked == null || apart(timeNs, looked) >= LOOK_EVERY_NS) {
            lookedNs = timeNs
            unseen = compensator.coverage().unseenDirections
            if (since != null && apart(timeNs, since) >= SAVE_EVERY_NS && save()) savedNs = timeNs
        }
    }

    /** Nanoseconds between two times; the clock may have begun anew between them, so either may be the later. */
    private fun apart(oneNs: Long, otherNs: Long): Double = abs(oneNs.toDouble() - otherNs.toDouble())

    /** Whether there was anything to save that the store does not keep already. */
    private fun save(): Boolean {
        if (store == null) return false
        val found = correction()
        if (found == null || found == saved) return false
        compensator.snapshotCalibration()?.let(store::save)
        saved = found
        return true
    }

    private fun correction() = compensator.calibration()?.let { Correction(it.softIron, it.hardIronUt) }

    /** What corrects a sample: of a calibration all but the field strength, which follows the noise of a device at rest. */
    private data class Correction(val softIron: SoftIron, val hardIronUt: Vector3)

    override fun close() {
        try {
            save()
        } catch (_: MagcompException) {
            // after a defect there is nothing to keep
        } finally {
            compensator.close()
        }
    }

    private companion object {
        /** About what a crash costs; flash memory wears out with more. */
        const val SAVE_EVERY_NS = 10_000_000_000L

        /** As often as an eye sees. */
        const val LOOK_EVERY_NS = 200_000_000L

        fun frameOf(config: Config) = HeadingFrame(
            config.heading?.axis ?: ReferenceAxis.TOP_EDGE,
            config.heading?.screenRotation ?: ScreenRotation.DEG0,
            config.heading?.declinationDeg,
        )
    }
}
