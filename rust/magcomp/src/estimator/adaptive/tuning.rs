//! Every choice of the adaptive estimator: unit, meaning, source. What can be learned from the stream is learned; what is
//! physics stands where it is used.

/// A kind of change and how far it moves the parameters, as standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jump {
    /// Diagonal of T, relative.
    pub diagonal: f64,
    /// Off-diagonal of T, relative.
    pub off_diagonal: f64,
    /// b, uT.
    pub hard_iron_ut: f64,
    /// Log of the prior probability among the kinds.
    pub log_prior: f64,
}

/// The choices. Development: `streams.py` seeds 1 to 6, `families.py` C, D.uneven5, B.drift0.1 seeds 1 to 6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuning {
    /// White noise before it is learned, uT: a Nexus 5 has 0.48, iPhones 0.7 to 1.1.
    pub noise_ut: f64,
    /// Least and largest white noise that is believed, uT: quantisation of 0.1 uT; a loud sensor.
    pub noise_range_ut: (f64, f64),
    /// Unevenness of a place before it is learned, uT, and the time for which it stays the same error, s.
    pub uneven_ut: f64,
    pub uneven_s: f64,
    /// Share of samples that are spikes, and the range they spread over, uT.
    pub spike_share: f64,
    pub spike_range_ut: f64,
    /// Changes of the device's disturbance an hour.
    pub hazard_per_h: f64,
    /// Changes that a surprising sample may begin: b alone by little and by much, b and M by little and by much.
    pub jumps: [Jump; 4],
    /// Other places, one a little different, one very: relative strength of the field, vertical part (field strengths).
    pub places: [(f64, f64); 2],
    /// Changes of the place an hour.
    pub places_per_h: f64,
    /// Least change of the field's strength, as a share, or of its vertical part, that is told as another place.
    pub least_place: f64,
    /// Changes that no sample announces, looked for all the time: b alone, b and M.
    pub quiet_jumps: [Jump; 2],
    /// b of a device at rest and of one whose b moves: random walk, uT per root second.
    pub walks_ut: [f64; 2],
    /// Log odds of beginning to move and of coming to rest, each time either is considered.
    pub log_begins_to_move: f64,
    pub log_comes_to_rest: f64,
    /// What a b that moves leaves open of what was known: T diagonal, off-diagonal, b (uT).
    pub moved: Jump,
    /// Rate of a b that moves, uT/s, and how long a rate lasts, s.
    pub rate_ut_s: f64,
    pub rate_s: f64,
    /// Deviation of M from a multiple of I before anything is known (standard deviations) and log priors.
    pub cold: [(f64, f64); 3],
    /// How far a calibration that was given is trusted: T relative, b in uT.
    pub given: (f64, f64),
    /// Log probability that everything is different from what is known.
    pub log_cold: f64,
    /// Least log joint probability, relative to the best, of a hypothesis that is kept.
    pub hopeless: f64,
    /// Samples nearer than this to one another are averaged, uT (4.5 standard deviations of noise on top), for at most so long, s.
    pub group_ut: f64,
    pub group_s: f64,
    /// Time between looks for a change that no sample announces, s.
    pub look_s: f64,
    /// Time over which samples stay moments before they may become prior, s.
    pub absorb_s: f64,
    /// Expected direction error (deg) below which they may (the linearisation holds), and for a b that moves.
    pub absorb_deg: f64,
    pub absorb_moving_deg: f64,
    /// Expected direction error (deg) above which samples are not judged by a hypothesis.
    pub unsure_deg: f64,
    /// Expected direction error (deg) above which another lobe of the ellipsoid is looked for.
    pub twin_deg: f64,
    /// Expected direction error (deg) below which an estimate is published.
    pub publish_deg: f64,
    /// Probability from which a change is decided, and the least change of directions that is told, deg.
    pub certain: f64,
    pub least_change_deg: f64,
    /// Changes that begin within so long of one another are one, s.
    pub one_change_s: f64,
    /// Time after which another place is what is usual, s.
    pub new_place_s: f64,
    /// A fit is worth while when the samples have become so many times more.
    pub growth: f64,
    /// Levenberg-Marquardt iterations a sample may cost in all.
    pub iterations: usize,
}

const fn jump(diagonal: f64, off_diagonal: f64, hard_iron_ut: f64, log_prior: f64) -> Jump {
    Jump { diagonal, off_diagonal, hard_iron_ut, log_prior }
}

impl Tuning {
    pub const PHONE: Self = Self {
        noise_ut: 0.5,
        noise_range_ut: (0.03, 4.0),
        uneven_ut: 1.3,
        uneven_s: 0.07,
        spike_share: 0.02,
        spike_range_ut: 100.0,
        hazard_per_h: 60.0,
        jumps: [
            jump(1e-3, 1e-3, 5.0, -1.0),
            jump(1e-3, 1e-3, 20.0, -1.0),
            jump(0.025, 0.02, 8.0, -2.0),
            jump(0.06, 0.04, 20.0, -2.0),
        ],
        places: [(0.05, 0.05), (0.3, 0.3)],
        places_per_h: 60.0,
        least_place: 0.1,
        quiet_jumps: [jump(1e-3, 1e-3, 8.0, -1.0), jump(0.03, 0.02, 8.0, -1.5)],
        walks_ut: [0.003, 0.05],
        log_begins_to_move: -5.0,
        log_comes_to_rest: -2.0,
        moved: jump(0.02, 0.015, 2.0, 0.0),
        rate_ut_s: 0.4,
        rate_s: 60.0,
        cold: [(0.03, -1.0), (0.1, -0.7), (0.25, -2.0)],
        given: (0.005, 2.0),
        log_cold: -6.0,
        hopeless: -30.0,
        group_ut: 2.0,
        group_s: 0.08,
        look_s: 0.16,
        absorb_s: 0.64,
        absorb_deg: 0.8,
        absorb_moving_deg: 6.0,
        unsure_deg: 8.0,
        twin_deg: 3.0,
        publish_deg: 10.0,
        certain: 0.99,
        least_change_deg: 1.5,
        one_change_s: 2.0,
        new_place_s: 30.0,
        growth: 1.15,
        iterations: 24,
    };
}
