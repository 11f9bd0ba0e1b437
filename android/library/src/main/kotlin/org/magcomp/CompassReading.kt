package org.magcomp

import android.content.res.Resources
import org.magcomp.core.*

/**
 * A reading for a screen: its heading is that of the axis and of the screen's rotation that were asked for ([Compass.headings]). It never
 * changes. [Compass.readings] has all else that the estimator says.
 */
public class CompassReading internal constructor(private val answer: Answer, private val axis: ReferenceAxis, private val rotation: ScreenRotation) {
    /** Time of the magnetometer sample, nanoseconds. */
    public val timeNs: Long get() = answer.timeNs

    /** The heading, clockwise from magnetic north, degrees, 0 to 360. It is null where there is none; [stream], or else [status], says why. */
    public val headingDeg: Double? get() = answer.headingDeg(axis, rotation)

    /** One standard deviation of [headingDeg], degrees. */
    public val headingSigmaDeg: Double? get() = answer.headingSigmaDeg(axis, rotation)

    /** The heading, clockwise from true north, degrees, 0 to 360. It is null also before [Compass.setPlace]. */
    public val trueHeadingDeg: Double? get() = answer.trueHeadingDeg(axis, rotation)

    /** How the phone is turned. [rotationMatrix] and [orientation] give it as Android does. */
    public val attitude: DeviceAttitude? get() = answer.attitude

    /** Azimuth, pitch and roll of the screen, as it is turned. */
    public val orientation: Orientation? get() = attitude?.orientation(rotation)

    /** What the compass is doing, and why. */
    public val status: CompensationStatus get() = answer.status

    /** The latest change that was decided; null before the first. */
    public val event: FieldEvent? get() = answer.event

    /** Whether the sensors deliver what a heading is made of. While the magnetometer is silent, [status] is `Rejected`. */
    public val stream: StreamStatus get() = answer.around.stream

    /** The phone's sensors in use; null if the source knows none, as a recording. */
    public val sensors: SensorsInUse? get() = answer.around.sensors

    /** As that of [CompensatedReading]. */
    public val storeError: Exception? get() = answer.around.storeError

    /** Where the field has not pointed yet, unit vectors in the device frame. The app may ask its user to turn the phone so that it does. */
    public val unseenDirections: List<DeviceVector> get() = answer.around.unseenDirections

    /** What headings from outside are worth ([Compass.aid]); null if none came of late. */
    public val headingAid: HeadingAid? get() = answer.around.headingAid

    /** One sentence for a screen, in the language of [resources]: what the stream lacks, or else the status. */
    public fun text(resources: Resources): String = stream.text(resources) ?: status.text(resources)

    /** What the user can do for a better heading, in the language of [resources]; null if there is nothing to do. */
    public fun guidance(resources: Resources): String? = if (stream == StreamStatus.Live) status.guidance(resources) else null

    /** The heading as a screen reader says it, in the language of [resources]. */
    public fun spoken(resources: Resources): String =
        headingDeg?.let { CompassHeading(it, headingSigmaDeg, trueHeadingDeg, null) }.spoken(resources)

    /** For logs. */
    override fun toString(): String =
        "CompassReading(headingDeg=$headingDeg, headingSigmaDeg=$headingSigmaDeg, trueHeadingDeg=$trueHeadingDeg, status=$status, stream=$stream)"
}

/** What a screen shows ([Compass.states]). */
public sealed class CompassState {
    /** No reading has come yet. */
    public data object Waiting : CompassState()

    /**
     * Readings come.
     *
     * @property reading the latest
     */
    public class Live(public val reading: CompassReading) : CompassState() {
        /** For logs. */
        override fun toString(): String = "Live($reading)"
    }

    /**
     * No more readings come.
     *
     * @property error why, such as a missing magnetometer, or [MagcompException.Closed]; null: the source has ended
     */
    public class Ended(public val error: Exception?) : CompassState() {
        /** For logs. */
        override fun toString(): String = "Ended($error)"
    }
}
