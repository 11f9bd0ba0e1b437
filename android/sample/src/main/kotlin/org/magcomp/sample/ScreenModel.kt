package org.magcomp.sample

import android.content.res.Resources
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.catch
import kotlinx.coroutines.flow.conflate
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.flow.onCompletion
import org.magcomp.Compass
import org.magcomp.CompassException
import org.magcomp.CompensatedReading
import org.magcomp.HeadingSmoother
import org.magcomp.compose.shownSigmaDeg
import org.magcomp.core.CompensationStatus
import org.magcomp.core.DeviceVector
import org.magcomp.core.ScreenRotation
import org.magcomp.guidance
import org.magcomp.spoken
import org.magcomp.text

/** What the screen shows, in the words of the phone's language. */
data class ScreenState(
    /** Where the rose is turned to, degrees clockwise from magnetic north; null: there is no heading. */
    val roseDeg: Double? = null,
    /** One standard deviation of the heading, degrees. */
    val sigmaDeg: Double = 180.0,
    val heading: String = "",
    val trueHeading: String? = null,
    val systemHeading: String? = null,
    val field: String? = null,
    val status: String = "",
    /** What to do about interference. */
    val banner: String? = null,
    /** The latest change that was decided. */
    val event: String? = null,
    /** What to do for a better heading. */
    val guidance: String? = null,
    val seen: String = "",
    /** What headings from outside are worth. */
    val help: String? = null,
    /** Where the field has not pointed yet, where it points now, and which of the former is nearest: unit vectors, x to the right of the screen. */
    val unseen: List<DeviceVector> = emptyList(),
    val pointing: DeviceVector? = null,
    val next: DeviceVector? = null,
    /** What a screen reader says of the rose. */
    val spoken: String = "",
)

/** All that the screen knows and how it says it. The heading is smoothed for the eye alone. */
class ScreenModel(private val resources: Resources) {
    private val smoother = HeadingSmoother(halfLifeS = 0.1)

    /**
     * A state for every reading that a screen can follow; an error is the last one. [systemDeg] is the system's own heading, [rotation] how far the
     * screen has turned.
     */
    fun states(compass: Compass, systemDeg: StateFlow<Double?>, rotation: () -> ScreenRotation = { ScreenRotation.DEG0 }): Flow<ScreenState> =
        compass.readings()
            .conflate()
            .map { show(it, systemDeg.value, rotation()) }
            .onCompletion { error -> if (error == null) emit(explain(null)) }
            .catch { emit(explain(it)) }

    fun show(answer: CompensatedReading, systemDeg: Double?, rotation: ScreenRotation = ScreenRotation.DEG0): ScreenState {
        val reading = answer.reading
        val heading = answer.headingOn(rotation)
        val roseDeg = smoother.push(reading.timeNs, heading?.headingDeg ?: Double.NaN)
        val lacking = answer.stream.text(resources)
        val guidance = if (lacking == null) reading.status.guidance(resources) else null
        val isDisturbed = reading.status is CompensationStatus.Disturbed
        val pointing = reading.fieldUt?.let { unit(it) }?.on(rotation)
        val unseen = answer.unseenDirections.map { it.on(rotation) }
        val next = pointing?.let { now -> unseen.maxByOrNull { it.x * now.x + it.y * now.y + it.z * now.z } }
        return ScreenState(
            roseDeg = if (heading == null) null else roseDeg,
            sigmaDeg = heading?.headingSigmaDeg ?: 180.0,
            heading = if (heading == null) say(R.string.no_heading) else say(R.string.heading, heading.headingDeg, shownSigmaDeg(heading.headingSigmaDeg)),
            trueHeading = heading?.trueHeadingDeg?.let { say(R.string.true_heading, it) },
            systemHeading = systemDeg?.let { say(R.string.system_heading, it) },
            field = reading.totalFieldUt?.let { say(R.string.field, it) },
            status = lacking ?: reading.status.text(resources),
            banner = guidance.takeIf { isDisturbed },
            event = reading.event?.text(resources),
            guidance = guidance?.takeIf { !isDisturbed }?.let { if (next == null) it else say(R.string.next, it) },
            seen = say(R.string.seen, 100 * reading.coverage),
            help = answer.headingAid?.text(resources),
            unseen = unseen,
            pointing = pointing,
            next = next,
            spoken = heading.spoken(resources),
        )
    }

    /** Why there are no readings any more, and nothing of those before. */
    fun explain(error: Throwable?): ScreenState {
        val why = when (error) {
            null -> say(R.string.over)
            is CompassException -> error.text(resources)
            else -> "$error"
        }
        return ScreenState(heading = say(R.string.no_heading), status = why, spoken = null.spoken(resources))
    }

    private fun say(id: Int, vararg values: Any): String = resources.getString(id, *values)

    /** From the device's frame to that of the screen as it is turned. */
    private fun DeviceVector.on(rotation: ScreenRotation) = when (rotation) {
        ScreenRotation.DEG0 -> this
        ScreenRotation.DEG90 -> DeviceVector(-y, x, z)
        ScreenRotation.DEG180 -> DeviceVector(-x, -y, z)
        ScreenRotation.DEG270 -> DeviceVector(y, -x, z)
    }

    private fun unit(v: DeviceVector): DeviceVector? {
        val length = Math.sqrt(v.x * v.x + v.y * v.y + v.z * v.z)
        return if (length > 0) DeviceVector(v.x / length, v.y / length, v.z / length) else null
    }
}
