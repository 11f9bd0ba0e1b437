@file:JvmName("Texts")

package org.magcomp

import android.content.res.Resources
import kotlin.math.abs
import kotlin.math.ceil
import kotlin.math.roundToInt

/**
 * One sentence an app may show, in the language of [resources]; an app translates or rewords it with a string resource of the
 * same name. In English it is what `text()` says, without a call into the native library.
 */
public fun CompensationStatus.text(resources: Resources): String = text(resources::getString)

/** One sentence an app may show of a change that was decided, in the language of [resources]. */
public fun FieldEvent.text(resources: Resources): String = text(resources::getString)

/** One sentence an app may show of what a stream lacks, in the language of [resources]; null: nothing. */
public fun StreamStatus.text(resources: Resources): String? = text(resources::getString)

/** What the user can do for a better heading, in the language of [resources]; null: nothing. */
public fun CompensationStatus.guidance(resources: Resources): String? = guidance()?.let(resources::getString)

/** One sentence an app may show of what headings from outside are worth, in the language of [resources]. */
public fun HeadingAid.text(resources: Resources): String = resources.getString(
    when (this) {
        HeadingAid.USED -> R.string.magcomp_aid_used
        HeadingAid.LEADS -> R.string.magcomp_aid_leads
        HeadingAid.DISAGREES -> R.string.magcomp_aid_disagrees
    },
)

/** The heading as a screen reader says it, in whole degrees, in the language of [resources]; null: that there is none. */
public fun CompassHeading?.spoken(resources: Resources): String = spoken(resources::getString)

/** A string resource with its placeholders filled. */
internal typealias Strings = (id: Int, values: Array<out Any>) -> String

internal fun CompensationStatus.text(strings: Strings): String = when (this) {
    is CompensationStatus.Collecting -> strings.say(R.string.magcomp_status_collecting, missing.text(strings))
    CompensationStatus.Tracking -> strings.say(R.string.magcomp_status_tracking)
    is CompensationStatus.Suspect -> strings.say(R.string.magcomp_status_suspect)
    is CompensationStatus.Held -> strings.say(R.string.magcomp_status_held, reason.text(strings))
    is CompensationStatus.Disturbed -> strings.say(R.string.magcomp_status_disturbed)
    is CompensationStatus.Rejected -> strings.say(R.string.magcomp_status_rejected, reason.text(strings))
}

internal fun StreamStatus.text(strings: Strings): String? = when (this) {
    StreamStatus.Live -> null
    StreamStatus.NoVertical -> strings.say(R.string.magcomp_stream_no_vertical)
    is StreamStatus.Silent -> strings.say(
        when {
            PhoneSensor.MAGNETOMETER in sensors && sensors.size > 1 -> R.string.magcomp_stream_silent_all
            PhoneSensor.MAGNETOMETER in sensors -> R.string.magcomp_stream_silent_magnetometer
            PhoneSensor.GRAVITY in sensors -> R.string.magcomp_stream_silent_gravity
            else -> R.string.magcomp_stream_silent_gyroscope
        },
    )
}

internal fun FieldEvent.text(strings: Strings): String {
    val id = when (kind) {
        FieldEventKind.DEVICE_STEP -> R.string.magcomp_event_device_step
        FieldEventKind.DEVICE_STEP_BACK -> R.string.magcomp_event_device_step_back
        FieldEventKind.PLACE_CHANGED -> R.string.magcomp_event_place_changed
    }
    return strings.say(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

internal fun CompassHeading?.spoken(strings: Strings): String {
    if (this == null) return strings.say(R.string.magcomp_spoken_no_heading)
    // 359.6 is 0
    return strings.say(R.string.magcomp_spoken_heading, headingDeg.roundToInt() % 360, ceil(headingSigmaDeg ?: 180.0).toInt())
}

internal fun CompensationStatus.guidance(): Int? = when (this) {
    is CompensationStatus.Collecting -> when (missing) {
        CollectingReason.Rotation -> R.string.magcomp_guidance_turn
        CollectingReason.Directions, is CollectingReason.Fit -> R.string.magcomp_guidance_eight
        is CollectingReason.Samples -> R.string.magcomp_guidance_pick_up
    }
    is CompensationStatus.Held -> when (reason) {
        HoldReason.TooLittleRotation -> R.string.magcomp_guidance_turn
        is HoldReason.FitRefused, HoldReason.LowUniformity -> R.string.magcomp_guidance_eight
        HoldReason.AtRest -> R.string.magcomp_guidance_pick_up
        HoldReason.NoGyroscope, HoldReason.Constant -> null
    }
    is CompensationStatus.Disturbed -> R.string.magcomp_guidance_walk_away
    CompensationStatus.Tracking, is CompensationStatus.Suspect, is CompensationStatus.Rejected -> null
}

private fun CollectingReason.text(strings: Strings): String = when (this) {
    is CollectingReason.Samples -> strings.say(R.string.magcomp_missing_samples, have, need)
    is CollectingReason.Fit -> problem.text(strings)
    CollectingReason.Rotation -> strings.say(R.string.magcomp_missing_rotation)
    CollectingReason.Directions -> strings.say(R.string.magcomp_missing_directions)
}

private fun HoldReason.text(strings: Strings): String = when (this) {
    HoldReason.LowUniformity -> strings.say(R.string.magcomp_held_low_uniformity)
    is HoldReason.FitRefused -> problem.text(strings)
    HoldReason.Constant -> strings.say(R.string.magcomp_held_constant)
    HoldReason.AtRest -> strings.say(R.string.magcomp_held_at_rest)
    HoldReason.TooLittleRotation -> strings.say(R.string.magcomp_held_too_little_rotation)
    HoldReason.NoGyroscope -> strings.say(R.string.magcomp_held_no_gyroscope)
}

private fun RejectReason.text(strings: Strings): String = when (this) {
    RejectReason.NotFinite -> strings.say(R.string.magcomp_rejected_not_finite)
    is RejectReason.OutOfRange -> strings.say(R.string.magcomp_rejected_out_of_range, valueUt, limitUt)
    is RejectReason.Saturated -> strings.say(R.string.magcomp_rejected_saturated, axis.name.lowercase(), valueUt, railUt)
    is RejectReason.TimeNotAfter -> strings.say(R.string.magcomp_rejected_time_not_after, timeNs, latestNs)
    is RejectReason.TimeJump -> strings.say(R.string.magcomp_rejected_time_jump, gapS, limitS)
    is RejectReason.Stuck -> strings.say(R.string.magcomp_rejected_stuck, repeats)
    is RejectReason.Axes -> strings.say(R.string.magcomp_rejected_axes, listOf(x, y, z).joinToString(",", transform = ::typed))
}

/** An axis as one types it: `-x`. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis) - 1]

private fun FitProblem.text(strings: Strings): String = when (this) {
    is FitProblem.TooFewSamples -> strings.say(R.string.magcomp_fit_too_few_samples, have)
    is FitProblem.Planar -> strings.say(R.string.magcomp_fit_planar, thicknessUt)
    is FitProblem.PoorCoverage -> strings.say(R.string.magcomp_fit_poor_coverage, directionSigmaDeg, limitDeg)
    is FitProblem.Inconsistent -> strings.say(R.string.magcomp_fit_inconsistent, residualUt, limitUt)
    FitProblem.NotAnEllipsoid -> strings.say(R.string.magcomp_fit_not_an_ellipsoid)
    is FitProblem.FieldOutOfRange -> strings.say(R.string.magcomp_fit_field_out_of_range, fieldUt, lowUt, highUt)
    FitProblem.NotFinite -> strings.say(R.string.magcomp_fit_not_finite)
}

private fun Strings.say(id: Int, vararg values: Any): String = this(id, values)
