// made by bindings/generate.sh from bindings/status.toml
@file:JvmName("Texts")
@file:JvmMultifileClass

package org.magcomp

import android.content.res.Resources
import kotlin.math.abs
import org.magcomp.core.*

/**
 * One sentence that an app may show, in the language of [resources]. An app translates or rewords it with a string resource of the same
 * name. In English it is the sentence of `text()`, without a call into the native library.
 */
public fun CompensationStatus.text(resources: Resources): String = when (this) {
    is CompensationStatus.Collecting -> resources.getString(R.string.magcomp_status_collecting, missing.text(resources))
    CompensationStatus.Tracking -> resources.getString(R.string.magcomp_status_tracking)
    is CompensationStatus.Suspect -> resources.getString(R.string.magcomp_status_suspect)
    is CompensationStatus.Held -> resources.getString(R.string.magcomp_status_held, reason.text(resources))
    is CompensationStatus.Disturbed -> resources.getString(R.string.magcomp_status_disturbed)
    is CompensationStatus.Rejected -> resources.getString(R.string.magcomp_status_rejected, reason.text(resources))
}

internal fun CollectingReason.text(resources: Resources): String = when (this) {
    is CollectingReason.Samples -> resources.getString(R.string.magcomp_missing_samples, have, need)
    is CollectingReason.Fit -> problem.text(resources)
    CollectingReason.Rotation -> resources.getString(R.string.magcomp_missing_rotation)
    CollectingReason.Directions -> resources.getString(R.string.magcomp_missing_directions)
}

internal fun HoldReason.text(resources: Resources): String = when (this) {
    HoldReason.LowUniformity -> resources.getString(R.string.magcomp_held_low_uniformity)
    is HoldReason.FitRefused -> problem.text(resources)
    HoldReason.Constant -> resources.getString(R.string.magcomp_held_constant)
    HoldReason.AtRest -> resources.getString(R.string.magcomp_held_at_rest)
    HoldReason.TooLittleRotation -> resources.getString(R.string.magcomp_held_too_little_rotation)
    HoldReason.NoGyroscope -> resources.getString(R.string.magcomp_held_no_gyroscope)
}

internal fun RejectReason.text(resources: Resources): String = when (this) {
    RejectReason.NotFinite -> resources.getString(R.string.magcomp_rejected_not_finite)
    is RejectReason.OutOfRange -> resources.getString(R.string.magcomp_rejected_out_of_range, valueUt, limitUt)
    is RejectReason.Saturated -> resources.getString(R.string.magcomp_rejected_saturated, axis.name.lowercase(), valueUt, railUt)
    is RejectReason.TimeNotAfter -> resources.getString(R.string.magcomp_rejected_time_not_after, timeNs, latestNs)
    is RejectReason.TimeJump -> resources.getString(R.string.magcomp_rejected_time_jump, gapS, limitS)
    is RejectReason.Stuck -> resources.getString(R.string.magcomp_rejected_stuck, repeats)
    is RejectReason.Axes -> resources.getString(R.string.magcomp_rejected_axes, listOf(x, y, z).joinToString(",", transform = ::typed))
}

internal fun FitProblem.text(resources: Resources): String = when (this) {
    is FitProblem.TooFewSamples -> resources.getString(R.string.magcomp_fit_too_few_samples, have)
    is FitProblem.Planar -> resources.getString(R.string.magcomp_fit_planar, thicknessUt)
    is FitProblem.PoorCoverage -> resources.getString(R.string.magcomp_fit_poor_coverage, directionSigmaDeg, limitDeg)
    is FitProblem.Inconsistent -> resources.getString(R.string.magcomp_fit_inconsistent, residualUt, limitUt)
    FitProblem.NotAnEllipsoid -> resources.getString(R.string.magcomp_fit_not_an_ellipsoid)
    is FitProblem.FieldOutOfRange -> resources.getString(R.string.magcomp_fit_field_out_of_range, fieldUt, lowUt, highUt)
    FitProblem.NotFinite -> resources.getString(R.string.magcomp_fit_not_finite)
}

/** An axis as one types it: `-x`. What is none is the nearest, as in the core's own text. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis).coerceIn(1, 3) - 1]

/** One sentence an app may show of a change that was decided, in the language of [resources]. */
public fun FieldEvent.text(resources: Resources): String {
    val id = when (kind) {
        FieldEventKind.DEVICE_STEP -> R.string.magcomp_event_device_step
        FieldEventKind.DEVICE_STEP_BACK -> R.string.magcomp_event_device_step_back
        FieldEventKind.PLACE_CHANGED -> R.string.magcomp_event_place_changed
    }
    return resources.getString(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

/** One sentence an app may show of what headings from outside are worth, in the language of [resources]. */
public fun HeadingAid.text(resources: Resources): String = resources.getString(
    when (this) {
        HeadingAid.USED -> R.string.magcomp_aid_used
        HeadingAid.LEADS -> R.string.magcomp_aid_leads
        HeadingAid.DISAGREES -> R.string.magcomp_aid_disagrees
    },
)

/** What the user can do for a better heading, in the language of [resources]; null if there is nothing to do. */
public fun CompensationStatus.guidance(resources: Resources): String? = when (this) {
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
}?.let(resources::getString)
