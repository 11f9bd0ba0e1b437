use super::*;

/// b is a field strength from the first sample, in any direction: on average its squared distance is 1, a third along each axis.
#[test]
fn a_cold_start_has_b_on_a_sphere_about_the_first_sample() {
    let u = Vector3::new(0.4, -1.2, 0.3);
    let belief = cold(&u, &Tuning::USED);
    let of_b = belief.covariance.fixed_view::<3, 3>(6, 6);
    assert!((of_b - Matrix3::from_diagonal_element(1.0 / 3.0)).amax() < 1e-12, "{of_b}");
    assert_eq!(Vector3::from(belief.mean.fixed_rows::<3>(6)), u);
    // neither the scale nor the vertical part is known
    assert_eq!((belief.covariance[(0, 1)], belief.covariance[(9, 9)]), (1.0, 1.0));
    let mut bank = Bank::new(45.0);
    bank.begin_cold(&Frame { u, up: Some(Vector3::z()), ..Frame::default() }, 0.0, false, &Tuning::USED);
    assert_eq!(bank.all.len(), 6);
}

/// Without a surprise a change is a small one, and sudden. A surprise may be a large one, take time, or bring the former calibration back.
#[test]
fn a_surprise_brings_changes_of_every_kind() {
    let frame = Frame { u: Vector3::new(0.4, -1.2, 0.3), ..Frame::default() };
    for (surprised, devices, formers) in [(false, 2, 0), (true, 6, 1)] {
        let mut bank = Bank::new(45.0);
        bank.begin_cold(&frame, 0.0, false, &Tuning::USED);
        let former = cold(&Vector3::new(1.0, 2.0, -3.0), &Tuning::USED);
        bank.former = Some(former);
        bank.all.truncate(1);
        bank.spawn(0, &frame, surprised, 0.1, &Tuning::USED);
        let of = |kind: Kind| bank.all.iter().filter(move |it| it.kind == kind && it.hard_iron == HardIron::Rests);
        assert_eq!((of(Kind::Device).count(), of(Kind::Place).count()), (devices, 2));
        assert_eq!(of(Kind::Device).filter(|it| it.takes_time).count(), devices / 2 * formers);
        assert_eq!(of(Kind::Former).count(), formers);
        assert!(of(Kind::Former).all(|it| it.now.tau() == former.mean));
        // 60 places and 6 devices an hour, each of two kinds or ways
        let of_place = of(Kind::Place).next().unwrap().now.log - of(Kind::Device).next().unwrap().now.log;
        assert!((of_place - 10.0_f64.ln()).abs() < 1e-9, "{of_place}");
    }
}

/// It may drift, which is no change, or slide, which is one. What is tried already, and likely, is not tried again.
#[test]
fn b_that_rests_may_move() {
    let frame = Frame { u: Vector3::new(0.4, -1.2, 0.3), time_ns: 7, ..Frame::default() };
    let spawned = |hard_iron: HardIron, tried: Option<(HardIron, f64)>| {
        let mut bank = Bank::new(45.0);
        bank.begin_cold(&frame, 0.0, false, &Tuning::USED);
        bank.all.truncate(1);
        (bank.all[0].hard_iron, bank.all[0].error) = (hard_iron, 0.99 * UNKNOWN_DEG.to_radians().powi(2));
        let id = bank.all[0].id;
        if let Some((hard_iron, behind)) = tried {
            let mut other = bank.all[0].clone();
            (other.hard_iron, other.id, other.now.log) = (hard_iron, 99, other.now.log - behind);
            bank.all.push(other);
        }
        bank.spawn(0, &frame, false, 0.1, &Tuning::USED);
        let of = |hard_iron: HardIron| bank.all.iter().filter(move |it| it.hard_iron == hard_iron);
        let ids = |hard_iron: HardIron| of(hard_iron).map(|it| it.id).collect::<Vec<_>>();
        if hard_iron == HardIron::Rests {
            assert!(
                of(HardIron::Slides).filter(|it| it.id != 99).all(|it| it.kind == Kind::Device && it.onset_ns == 7)
            );
            assert!(of(HardIron::Drifts).all(|it| it.kind == Kind::Cold));
        }
        (id, ids(HardIron::Drifts), ids(HardIron::Slides))
    };
    let (id, drifts, slides) = spawned(HardIron::Rests, None);
    assert_eq!((drifts, slides.len()), (vec![id], 1));
    assert!(slides[0] > id);
    assert_eq!(spawned(HardIron::Rests, Some((HardIron::Slides, 8.9))).2, [99]);
    assert!(spawned(HardIron::Rests, Some((HardIron::Slides, 9.1))).2[0] != 99);
    // a cold start of which nothing is known
    let mut bank = Bank::new(45.0);
    bank.begin_cold(&frame, 0.0, false, &Tuning::USED);
    bank.all[0].error = 1.01 * UNKNOWN_DEG.to_radians().powi(2);
    bank.spawn(0, &frame, true, 0.1, &Tuning::USED);
    assert!(bank.all.iter().all(|it| it.hard_iron == HardIron::Rests));
    for (hard_iron, slides) in [(HardIron::Drifts, 0), (HardIron::Slides, 1)] {
        assert_eq!(spawned(hard_iron, None).2.len(), slides, "{hard_iron:?}");
    }
}

/// What a change replaced is kept to come back to, as soon as what came after it may be published, and not while b still slides.
#[test]
fn the_former_calibration_is_kept_once_the_one_after_it_is_of_use() {
    let frame = Frame { u: Vector3::new(0.4, -1.2, 0.3), ..Frame::default() };
    let kept = |variance: f64, hard_iron: HardIron| {
        let known = Gaussian {
            mean: tau_of(&Matrix3::identity(), &Vector3::zeros()),
            covariance: TauMatrix::from_diagonal_element(variance),
        };
        let mut bank = Bank::new(45.0);
        bank.begin_given(&frame, &known);
        (bank.all[0].former, bank.all[0].hard_iron) = (Some(cold(&frame.u, &Tuning::USED)), hard_iron);
        bank.prune(&Tuning::USED);
        (bank.former.is_some(), bank.best().map(|it| it.error.sqrt().to_degrees()))
    };
    assert!(matches!(kept(0.006, HardIron::Rests), (true, Some(8.0..10.0))), "{:?}", kept(0.006, HardIron::Rests));
    assert!(matches!(kept(0.01, HardIron::Rests), (false, Some(10.0..12.0))), "{:?}", kept(0.01, HardIron::Rests));
    assert!(!kept(0.006, HardIron::Slides).0);
}

/// Of two numbers that say three quarters and a quarter, by hand.
#[test]
fn a_mixture_has_the_mean_and_the_second_moment_of_its_parts() {
    let frame = Frame { u: Vector3::new(0.4, -1.2, 0.3), ..Frame::default() };
    let mut bank = Bank::new(45.0);
    assert!(bank.mixture().is_none() && bank.probability(|_| true) == 0.0);
    bank.begin_given(
        &frame,
        &Gaussian {
            mean: tau_of(&Matrix3::identity(), &Vector3::zeros()),
            covariance: TauMatrix::from_diagonal_element(0.01),
        },
    );
    bank.begin_given(
        &frame,
        &Gaussian {
            mean: tau_of(&Matrix3::identity(), &Vector3::new(0.4, 0.0, -0.8)),
            covariance: TauMatrix::from_diagonal_element(0.05),
        },
    );
    bank.all[1].now.log -= 3f64.ln();
    let found = bank.mixture().expect("two");
    let b = Vector3::from(found.mean.fixed_rows::<3>(6));
    assert!((b - Vector3::new(0.1, 0.0, -0.2)).norm() < 1e-12, "{b}");
    // 0.75 * 0.01 + 0.25 * 0.05, and 0.75 * 0.25 of the squares of what lies between
    let (own, between) = (0.02, 0.1875);
    for (i, j, expected) in [
        (0, 0, own),
        (6, 6, own + between * 0.16),
        (7, 7, own),
        (8, 8, own + between * 0.64),
        (6, 8, -between * 0.32),
        (0, 6, 0.0),
    ] {
        assert!((found.covariance[(i, j)] - expected).abs() < 1e-9, "{i}, {j}: {}", found.covariance[(i, j)]);
    }
    assert!((bank.probability(|it| it.id == 1) - 0.75).abs() < 1e-12);
    assert_eq!(bank.all.len(), 2);
    bank.clear();
    assert_eq!((bank.all.len(), bank.next_id, bank.best().is_none()), (0, 0, true));
}

/// By hand: T = k M^-1, so that where M is near I and k is 2, T's error is -2 that of M, and that of b is told in units.
#[test]
fn a_given_calibration_is_told_in_units_with_its_covariance() {
    let unit_ut = 50.0;
    let b_ut = Vector3::new(100.0, -50.0, 25.0);
    let calibration = crate::calibration::Calibration::new(Matrix3::identity(), b_ut, 25.0).expect("a calibration");
    let covariance = SMatrix::<f64, 9, 9>::from_diagonal(&[4.0, 4.0, 4.0, 1e-4, 1e-4, 1e-4, 4e-4, 4e-4, 4e-4].into());
    let found = given(&Given { calibration, covariance }, unit_ut, 0.2);
    for (k, value) in [2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 2.0, -1.0, 0.5, 0.0].into_iter().enumerate() {
        assert!((found.mean[k] - value).abs() < 1e-12, "{k}: {}", found.mean[k]);
    }
    // the strength of a place differs by a fifth: all of T's diagonal together
    let place = 0.04 * 4.0;
    for (i, j, expected) in [
        (0, 0, 4.0 * 1e-4 + place + LEAST_VARIANCE),
        (0, 1, place),
        (3, 3, 4.0 * 4e-4 + LEAST_VARIANCE),
        (3, 4, 0.0),
        (6, 6, 4.0 / 2500.0 + LEAST_VARIANCE),
        (0, 6, 0.0),
        (9, 9, 1.0),
    ] {
        assert!((found.covariance[(i, j)] - expected).abs() < 1e-12, "{i}, {j}: {}", found.covariance[(i, j)]);
    }
}

/// The field turned by 0.3 units a frame of 0.1 s: 3 units a second, by the last eight frames alone.
#[test]
fn how_fast_the_field_turned_is_of_the_last_eight_frames() {
    let mut bank = Bank::new(45.0);
    let mut x = 0.0;
    for k in 0..20 {
        x += if k < 20 - LATELY as i64 { 5.0 } else { 0.3 };
        bank.frames.push(Frame { u: Vector3::new(x, 1.0, -1.0), seconds: 0.1, ..Frame::default() });
    }
    assert!((bank.turning() - 3.0).abs() < 1e-9, "{}", bank.turning());
}

/// Those that are hopeless go, but for young cold starts; of two that say the same the likelier stays; at most eighteen are left.
#[test]
fn the_hopeless_and_the_needless_go() {
    let frame = Frame { u: Vector3::new(0.4, -1.2, 0.3), ..Frame::default() };
    let here = |x: f64| Gaussian {
        mean: tau_of(&Matrix3::identity(), &Vector3::new(x, 0.0, 0.0)),
        covariance: TauMatrix::identity(),
    };
    let mut bank = Bank::new(45.0);
    for k in 0..5 {
        bank.begin_given(&frame, &here(f64::from(k)));
        bank.all[k as usize].parent = k as u32; // so that they do not say the same
    }
    bank.all[1].now.log = 0.01 - HOPELESS;
    bank.all[2].now.log = -0.01 - HOPELESS;
    bank.all[3].now.log = -0.01 - HOPELESS;
    bank.all[3].kind = Kind::Cold;
    bank.all[4].now.log = f64::NEG_INFINITY;
    bank.prune(&Tuning::USED);
    let mut ids: Vec<_> = bank.all.iter().map(|it| it.id).collect();
    ids.sort_unstable();
    assert_eq!(ids, [1, 2, 4]);
    // it is old after eight frames
    bank.frames.next = LATELY;
    bank.prune(&Tuning::USED);
    assert_eq!(bank.all.len(), 2);
    // twins: of the same beginning and place
    let mut twin = bank.all[0].clone();
    twin.now.log -= 1.0;
    bank.all.push(twin);
    bank.prune(&Tuning::USED);
    assert_eq!(bank.all.len(), 2);
    for k in 0..30 {
        bank.begin_given(&frame, &here(10.0 + f64::from(k)));
        let last = bank.all.len() - 1;
        bank.all[last].parent = 100 + k as u32;
        bank.all[last].now.log = 1.0;
    }
    bank.prune(&Tuning::USED);
    assert_eq!(bank.all.len(), KEPT);
    assert!(bank.all.iter().all(|it| it.now.log == 1.0));
}
