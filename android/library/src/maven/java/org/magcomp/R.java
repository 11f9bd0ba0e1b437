package org.magcomp;

/** Stands in for the class that Android's tools make of the resources; made by bindings/generate.sh from bindings/status.toml and bindings/texts.toml. No artifact has it. */
final class R {
    static final class string {
        static int magcomp_status_collecting = 0x7f0e0000;
        static int magcomp_status_tracking = 0x7f0e0001;
        static int magcomp_status_suspect = 0x7f0e0002;
        static int magcomp_status_held = 0x7f0e0003;
        static int magcomp_status_disturbed = 0x7f0e0004;
        static int magcomp_status_rejected = 0x7f0e0005;
        static int magcomp_missing_samples = 0x7f0e0006;
        static int magcomp_missing_rotation = 0x7f0e0007;
        static int magcomp_missing_directions = 0x7f0e0008;
        static int magcomp_held_low_uniformity = 0x7f0e0009;
        static int magcomp_held_constant = 0x7f0e000a;
        static int magcomp_held_at_rest = 0x7f0e000b;
        static int magcomp_held_too_little_rotation = 0x7f0e000c;
        static int magcomp_held_no_gyroscope = 0x7f0e000d;
        static int magcomp_rejected_not_finite = 0x7f0e000e;
        static int magcomp_rejected_out_of_range = 0x7f0e000f;
        static int magcomp_rejected_saturated = 0x7f0e0010;
        static int magcomp_rejected_time_not_after = 0x7f0e0011;
        static int magcomp_rejected_time_jump = 0x7f0e0012;
        static int magcomp_rejected_stuck = 0x7f0e0013;
        static int magcomp_rejected_axes = 0x7f0e0014;
        static int magcomp_fit_too_few_samples = 0x7f0e0015;
        static int magcomp_fit_planar = 0x7f0e0016;
        static int magcomp_fit_poor_coverage = 0x7f0e0017;
        static int magcomp_fit_inconsistent = 0x7f0e0018;
        static int magcomp_fit_not_an_ellipsoid = 0x7f0e0019;
        static int magcomp_fit_field_out_of_range = 0x7f0e001a;
        static int magcomp_fit_not_finite = 0x7f0e001b;
        static int magcomp_event_device_step = 0x7f0e001c;
        static int magcomp_event_device_step_back = 0x7f0e001d;
        static int magcomp_event_place_changed = 0x7f0e001e;
        static int magcomp_aid_used = 0x7f0e001f;
        static int magcomp_aid_leads = 0x7f0e0020;
        static int magcomp_aid_disagrees = 0x7f0e0021;
        static int magcomp_guidance_turn = 0x7f0e0022;
        static int magcomp_guidance_eight = 0x7f0e0023;
        static int magcomp_guidance_pick_up = 0x7f0e0024;
        static int magcomp_guidance_walk_away = 0x7f0e0025;
        static int magcomp_spoken_heading = 0x7f0e0026;
        static int magcomp_spoken_no_heading = 0x7f0e0027;
        static int magcomp_starting = 0x7f0e0028;
        static int magcomp_stream_silent_all = 0x7f0e0029;
        static int magcomp_stream_silent_magnetometer = 0x7f0e002a;
        static int magcomp_stream_silent_gravity = 0x7f0e002b;
        static int magcomp_stream_silent_gyroscope = 0x7f0e002c;
        static int magcomp_stream_no_vertical = 0x7f0e002d;
        static int magcomp_error_missing = 0x7f0e002e;
        static int magcomp_error = 0x7f0e002f;
    }
}
