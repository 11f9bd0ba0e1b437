// made by bindings/generate.sh from bindings/status.toml
package org.magcomp

import kotlin.math.abs
import org.magcomp.core.*

internal fun CompensationStatus.text(strings: Strings): String = when (this) {
    is CompensationStatus.Collecting -> strings.say(R.string.magcomp_status_collecting, missing.text(strings))
    CompensationStatus.Tracking -> strings.say(R.string.magcomp_status_tracking)
    is CompensationStatus.Suspect -> strings.say(R.string.magcomp_status_suspect)
    is CompensationStatus.Held -> strings.say(R.string.magcomp_status_held, reason.text(strings))
    is CompensationStatus.Disturbed -> strings.say(R.string.magcomp_status_disturbed)
    is CompensationStatus.Rejected -> strings.say(R.string.magcomp_status_rejected, reason.text(strings))
}

internal fun CollectingReason.text(strings: Strings): String = when (this) {
    is CollectingReason.Samples -> strings.say(R.string.magcomp_missing_samples, have, need)
    is CollectingReason.Fit -> problem.text(strings)
    CollectingReason.Rotation -> strings.say(R.string.magcomp_missing_rotation)
    CollectingReason.Directions -> strings.say(R.string.magcomp_missing_directions)
}

internal fun HoldReason.text(strings: Strings): String = when (this) {
    HoldReason.LowUniformity -> strings.say(R.string.magcomp_held_low_uniformity)
    is HoldReason.FitRefused -> problem.text(strings)
    HoldReason.Constant -> strings.say(R.string.magcomp_held_constant)
    HoldReason.AtRest -> strings.say(R.string.magcomp_held_at_rest)
    HoldReason.TooLittleRotation -> strings.say(R.string.magcomp_held_too_little_rotation)
    HoldReason.NoGyroscope -> strings.say(R.string.magcomp_held_no_gyroscope)
}

internal fun RejectReason.text(strings: Strings): String = when (this) {
    RejectReason.NotFinite -> strings.say(R.string.magcomp_rejected_not_finite)
    is RejectReason.OutOfRange -> strings.say(R.string.magcomp_rejected_out_of_range, valueUt, limitUt)
    is RejectReason.Saturated -> strings.say(R.string.magcomp_rejected_saturated, axis.name.lowercase(), valueUt, railUt)
    is RejectReason.TimeNotAfter -> strings.say(R.string.magcomp_rejected_time_not_after, timeNs, latestNs)
    is RejectReason.TimeJump -> strings.say(R.string.magcomp_rejected_time_jump, gapS, limitS)
    is RejectReason.Stuck -> strings.say(R.string.magcomp_rejected_stuck, repeats)
    is RejectReason.Axes -> strings.say(R.string.magcomp_rejected_axes, listOf(x, y, z).joinToString(",", transform = ::typed))
}

internal fun FitProblem.text(strings: Strings): String = when (this) {
    is FitProblem.TooFewSamples -> strings.say(R.string.magcomp_fit_too_few_samples, have)
    is FitProblem.Planar -> strings.say(R.string.magcomp_fit_planar, thicknessUt)
    is FitProblem.PoorCoverage -> strings.say(R.string.magcomp_fit_poor_coverage, directionSigmaDeg, limitDeg)
    is FitProblem.Inconsistent -> strings.say(R.string.magcomp_fit_inconsistent, residualUt, limitUt)
    FitProblem.NotAnEllipsoid -> strings.say(R.string.magcomp_fit_not_an_ellipsoid)
    is FitProblem.FieldOutOfRange -> strings.say(R.string.magcomp_fit_field_out_of_range, fieldUt, lowUt, highUt)
    FitProblem.NotFinite -> strings.say(R.string.magcomp_fit_not_finite)
}

/** An axis as one types it: `-x`. What is none is the nearest, as in the core's own text. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis).coerceIn(1, 3) - 1]

internal fun FieldEvent.text(strings: Strings): String {
    val id = when (kind) {
        FieldEventKind.DEVICE_STEP -> R.string.magcomp_event_device_step
        FieldEventKind.DEVICE_STEP_BACK -> R.string.magcomp_event_device_step_back
        FieldEventKind.PLACE_CHANGED -> R.string.magcomp_event_place_changed
    }
    return strings.say(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

internal fun HeadingAid.text(strings: Strings): String = strings.say(
    when (this) {
        HeadingAid.USED -> R.string.magcomp_aid_used
        HeadingAid.LEADS -> R.string.magcomp_aid_leads
        HeadingAid.DISAGREES -> R.string.magcomp_aid_disagrees
    },
)

internal fun CompensationStatus.guidance(): Int? = when (this) {
    is CompensationStatus.Collecting -> when (missing) {
        is CollectingReason.Samples -> R.string.magcomp_guidance_pick_up
        is CollectingReason.Fit -> R.string.magcomp_guidance_eight
        CollectingReason.Rotation -> R.string.magcomp_guidance_turn
        CollectingReason.Directions -> R.string.magcomp_guidance_eight
    }
    CompensationStatus.Tracking -> null
    is CompensationStatus.Suspect -> null
    is CompensationStatus.Held -> when (reason) {
        HoldReason.LowUniformity -> R.string.magcomp_guidance_eight
        is HoldReason.FitRefused -> R.string.magcomp_guidance_eight
        HoldReason.Constant -> null
        HoldReason.AtRest -> R.string.magcomp_guidance_pick_up
        HoldReason.TooLittleRotation -> R.string.magcomp_guidance_turn
        HoldReason.NoGyroscope -> null
    }
    is CompensationStatus.Disturbed -> R.string.magcomp_guidance_walk_away
    is CompensationStatus.Rejected -> null
}
