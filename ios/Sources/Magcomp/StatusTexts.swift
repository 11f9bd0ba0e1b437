// swift-format-ignore-file
// made by bindings/generate.sh from bindings/status.toml

import Foundation

extension CompensationStatus {
    /// One sentence an app may show, in the app's language where the package has it, else in English.
    public var localizedText: String {
        switch self {
        case .collecting(let missing): say("status_collecting", missing.localizedText)
        case .tracking: say("status_tracking")
        case .suspect: say("status_suspect")
        case .held(let reason): say("status_held", reason.localizedText)
        case .disturbed: say("status_disturbed")
        case .rejected(let reason): say("status_rejected", reason.localizedText)
        }
    }
}

extension CompensationStatus.CollectingReason {
    fileprivate var localizedText: String {
        switch self {
        case .samples(let have, let need): say("missing_samples", Int64(have), Int64(need))
        case .fit(let problem): problem.localizedText
        case .rotation: say("missing_rotation")
        case .directions: say("missing_directions")
        }
    }
}

extension CompensationStatus.HoldReason {
    fileprivate var localizedText: String {
        switch self {
        case .lowUniformity: say("held_low_uniformity")
        case .fitRefused(let problem): problem.localizedText
        case .constant: say("held_constant")
        case .atRest: say("held_at_rest")
        case .tooLittleRotation: say("held_too_little_rotation")
        case .noGyroscope: say("held_no_gyroscope")
        }
    }
}

extension CompensationStatus.RejectReason {
    fileprivate var localizedText: String {
        switch self {
        case .notFinite: say("rejected_not_finite")
        case .outOfRange(let valueUt, let limitUt): say("rejected_out_of_range", valueUt, limitUt)
        case .saturated(let axis, let valueUt, let railUt): say("rejected_saturated", axis.name, valueUt, railUt)
        case .timeNotAfter(let timeNs, let latestNs): say("rejected_time_not_after", timeNs, latestNs)
        case .timeJump(let gapS, let limitS): say("rejected_time_jump", gapS, limitS)
        case .stuck(let repeats): say("rejected_stuck", Int64(repeats))
        case .axes(let x, let y, let z): say("rejected_axes", [x, y, z].map(typed).joined(separator: ","))
        }
    }
}

extension CompensationStatus.FitProblem {
    fileprivate var localizedText: String {
        switch self {
        case .tooFewSamples(let have): say("fit_too_few_samples", Int64(have))
        case .planar(let thicknessUt): say("fit_planar", thicknessUt)
        case .poorCoverage(let directionSigmaDeg, let limitDeg): say("fit_poor_coverage", directionSigmaDeg, limitDeg)
        case .inconsistent(let residualUt, let limitUt): say("fit_inconsistent", residualUt, limitUt)
        case .notAnEllipsoid: say("fit_not_an_ellipsoid")
        case .fieldOutOfRange(let fieldUt, let lowUt, let highUt): say("fit_field_out_of_range", fieldUt, lowUt, highUt)
        case .notFinite: say("fit_not_finite")
        }
    }
}

extension CompensatedReading.HeadingAid {
    /// One sentence an app may show of what headings from outside are worth, in the app's language where the package has it, else in English.
    public var localizedText: String {
        switch self {
        case .used: say("aid_used")
        case .leads: say("aid_leads")
        case .disagrees: say("aid_disagrees")
        }
    }
}

/// An axis as one types it: `-x`. What is none is the nearest.
private func typed(_ axis: Int) -> String {
    (axis < 0 ? "-" : "") + ["x", "y", "z"][min(max(Int(clamping: axis.magnitude), 1), 3) - 1]
}

extension CompensationStatus {
    /// What the person can do for a better heading, in the app's language; nil: nothing.
    public var localizedGuidance: String? {
        switch self {
        case .collecting(.samples): say("guidance_pick_up")
        case .collecting(.fit): say("guidance_eight")
        case .collecting(.rotation): say("guidance_turn")
        case .collecting(.directions): say("guidance_eight")
        case .tracking: nil
        case .suspect: nil
        case .held(.lowUniformity): say("guidance_eight")
        case .held(.fitRefused): say("guidance_eight")
        case .held(.constant): nil
        case .held(.atRest): say("guidance_pick_up")
        case .held(.tooLittleRotation): say("guidance_turn")
        case .held(.noGyroscope): nil
        case .disturbed: say("guidance_walk_away")
        case .rejected: nil
        }
    }
}

extension FieldEvent {
    /// One sentence an app may show of a change that was decided, in the app's language.
    public var localizedText: String {
        let tookS = (Double(decidedNs) - Double(sinceNs)) * 1e-9
        return switch kind {
        case .deviceStep: say("event_device_step", tookS)
        case .deviceStepBack: say("event_device_step_back", tookS)
        case .placeChanged: say("event_place_changed", tookS)
        }
    }
}
