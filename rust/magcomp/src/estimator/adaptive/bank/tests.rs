use super::*;

/// b is a field strength from the first sample, in any direction: on average its squared distance is 1, a third along each axis.
#[test]
fn a_cold_start_has_b_on_a_sphere_about_the_first_sample() {
    let u = Vector3::new(0.4, -1.2, 0.3);
    let belief = cold(&u, &Tuning::USED);
    let of_b = belief.covariance.fixed_view::<3, 3>(6, 6);
    assert!((of_b - Matrix3::from_diagonal_element(1.0 / 3.0)).amax() < 1e-12, "{of_b}");
    assert_eq!(Vector3::from(belief.mean.fixed_rows::<3>(6)), u);
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
        let of = |kind: Kind| bank.all.iter().filter(move |it| it.kind == kind && !it.moves);
        assert_eq!((of(Kind::Device).count(), of(Kind::Place).count()), (devices, 2));
        assert_eq!(of(Kind::Device).filter(|it| it.takes_time).count(), devices / 2 * formers);
        assert_eq!(of(Kind::Former).count(), formers);
        assert!(of(Kind::Former).all(|it| it.known().mean == former.mean));
        // 60 places and 6 devices an hour, each of two kinds or ways
        let of_place = of(Kind::Place).next().unwrap().now.log - of(Kind::Device).next().unwrap().now.log;
        assert!((of_place - 10.0_f64.ln()).abs() < 1e-9, "{of_place}");
    }
}
