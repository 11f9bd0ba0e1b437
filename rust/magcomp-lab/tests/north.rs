//! Headings from outside: what they are worth in a car and in an uneven place, and what a wrong source costs.

#[allow(dead_code, reason = "no count is judged here")]
mod limits;

use limits::runs;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use magcomp::{Compensator, HeadedAxis, HeadingAid, HeadingSample, NorthReference};
use magcomp_lab::catalogue::find;
use magcomp_lab::random::{Purpose, Random};
use magcomp_lab::simulate::Simulation;

/// Rows from here on count, s.
const FROM_S: f64 = 60.0;

/// A source of headings.
#[derive(Clone, Copy)]
struct Source {
    every_s: f64,
    late_s: f64,
    sigma_deg: f64,
    /// Of the vehicle, turned against the device by so much; else of the device's top edge.
    vehicle: bool,
    /// From, to: turned by 180 degrees.
    wrong_s: (f64, f64),
    /// From, to: nothing comes.
    silent_s: (f64, f64),
}

impl Source {
    /// What it tells of this attitude.
    fn heading(
        &self,
        time_ns: i64,
        attitude: &UnitQuaternion<f64>,
        vehicle_deg: f64,
        random: &mut Random,
    ) -> HeadingSample {
        // an app tells the heading of what points to the horizon
        let is_level = (attitude * Vector3::y()).xy().norm() > 0.5;
        let axis = if is_level { Vector3::y() } else { -Vector3::z() };
        let pointing = attitude * axis;
        let true_deg = if self.vehicle { vehicle_deg } else { pointing.x.atan2(pointing.y).to_degrees() };
        let is_wrong = (self.wrong_s.0..self.wrong_s.1).contains(&(time_ns as f64 * 1e-9));
        let heading_deg = true_deg + random.normal() * self.sigma_deg + if is_wrong { 180.0 } else { 0.0 };
        HeadingSample {
            time_ns,
            heading_deg: heading_deg.rem_euclid(360.0),
            sigma_deg: self.sigma_deg,
            reference: NorthReference::Magnetic,
            axis: if self.vehicle { HeadedAxis::Vehicle } else { HeadedAxis::Device(axis) },
        }
    }
}

const GOOD: Source =
    Source { every_s: 10.0, late_s: 1.0, sigma_deg: 8.0, vehicle: false, wrong_s: (0.0, 0.0), silent_s: (0.0, 0.0) };

/// What came of a stream: time (s), error of north (degrees), sigma (degrees), what the headings were worth.
struct Row {
    time_s: f64,
    error_deg: f64,
    sigma_deg: f64,
    aid: Option<HeadingAid>,
}

fn run(variant: &str, seed: u64, source: Option<Source>) -> Vec<Row> {
    let variant = find(variant).unwrap().in_an_even_place();
    let scenario = variant.scenario(seed);
    let stream: Simulation = scenario.run();
    let mut compensator = Compensator::new(variant.config()).unwrap();
    let (mut rates, mut ups) = (stream.rotation_rates.iter().peekable(), stream.ups.iter().peekable());
    let mut random = Random::new(seed, Purpose::Bootstrap);
    let (mut next_s, mut late) = (0.0, std::collections::VecDeque::new());
    let mut rows = Vec::new();
    for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
        while let Some(event) = rates.next_if(|event| event.time_ns <= sample.time_ns) {
            let _ = compensator.push_rotation_rate(*event);
        }
        while let Some(event) = ups.next_if(|event| event.time_ns <= sample.time_ns) {
            let _ = compensator.push_up(*event);
        }
        let time_s = sample.time_ns as f64 * 1e-9;
        if let Some(source) = source
            && time_s >= next_s
        {
            next_s = time_s + source.every_s;
            let vehicle_deg = -scenario.trajectory.vehicle_yaw(time_s).to_degrees();
            let heading = source.heading(sample.time_ns, &truth.attitude, vehicle_deg, &mut random);
            if !(source.silent_s.0..source.silent_s.1).contains(&time_s) {
                late.push_back(heading);
            }
        }
        let due_ns = source.map_or(0, |source| sample.time_ns - (source.late_s * 1e9) as i64);
        while late.front().is_some_and(|heading: &HeadingSample| heading.time_ns <= due_ns) {
            let _ = compensator.push_heading(late.pop_front().unwrap());
        }
        let reading = compensator.push(*sample);
        if let Some(attitude) = reading.attitude {
            let north = attitude.to_world * (truth.attitude.inverse() * Vector3::y());
            rows.push(Row {
                time_s,
                error_deg: north.x.atan2(north.y).to_degrees(),
                sigma_deg: reading.heading.and_then(|it| it.heading_sigma_deg).unwrap_or(180.0),
                aid: compensator.heading_aid(),
            });
        }
    }
    rows
}

/// What came of a variant over eight seeds.
struct Judged {
    /// Median of the rms error from `FROM_S` on, degrees.
    error_deg: f64,
    /// Share of all rows within two sigmas.
    within: f64,
    /// Share of the rows in which headings from outside lead.
    leads: f64,
}

fn judged(variant: &str, name: &str, source: Option<Source>) -> Judged {
    let (mut errors, mut within, mut leads, mut count) = (Vec::new(), 0.0, 0.0, 0.0);
    for seed in 1..=8 {
        let rows: Vec<_> = run(variant, seed, source).into_iter().filter(|row| row.time_s > FROM_S).collect();
        errors.push((rows.iter().map(|row| row.error_deg.powi(2)).sum::<f64>() / rows.len() as f64).sqrt());
        within += rows.iter().filter(|row| row.error_deg.abs() < 2.0 * row.sigma_deg).count() as f64;
        leads += rows.iter().filter(|row| row.aid == Some(HeadingAid::Leads)).count() as f64;
        count += rows.len() as f64;
    }
    errors.sort_by(f64::total_cmp);
    let it = Judged { error_deg: (errors[3] + errors[4]) / 2.0, within: within / count, leads: leads / count };
    println!("{variant:18} {name:24} {:5.1} deg  {:.3}  {:.2}", it.error_deg, it.within, it.leads);
    it
}

#[test]
fn in_a_car_headings_from_outside_are_worth_their_sigma() {
    println!("variant            headings                 error      in2    lead");
    let alone = judged("places.car-hand", "none", None);
    let seldom = judged("places.car-hand", "each 10 s, 8 deg", Some(GOOD));
    let often = judged("places.car-hand", "each second, 8 deg", Some(Source { every_s: 1.0, ..GOOD }));
    assert!(alone.error_deg > 12.0, "or there is nothing to help");
    assert!(seldom.error_deg < 0.5 * alone.error_deg && often.error_deg < 0.35 * alone.error_deg);
    // an error that lasts is not averaged: ten a second are not worth ten
    assert!(often.error_deg > 2.0);
    for it in [seldom, often] {
        assert!(it.within > 0.85 && it.leads > 0.9, "{} {}", it.within, it.leads);
    }
    if runs(0, 1) > 0 {
        judged("places.car-mount", "none", None); // for the table alone
    }
    let course = judged("places.car-mount", "course each second", Some(Source { every_s: 1.0, vehicle: true, ..GOOD }));
    // the field of a car that turns with it: the magnetometer is too sure of it
    assert!(course.error_deg < 8.0 && course.within > 0.85);
}

#[test]
fn in_an_uneven_place_they_help_and_in_a_quiet_one_they_do_no_harm() {
    let alone = judged("places.uneven10", "none", None);
    let often = judged("places.uneven10", "each second, 8 deg", Some(Source { every_s: 1.0, ..GOOD }));
    assert!(often.error_deg < 0.8 * alone.error_deg && often.within > 0.95);
    let alone = judged("motion.walk", "none", None);
    let often = judged("motion.walk", "each second, 8 deg", Some(Source { every_s: 1.0, ..GOOD }));
    assert!((often.error_deg - alone.error_deg).abs() < 0.2);
}

/// Half a minute of headings that are wrong by 180 degrees, in a car, beside half a minute without headings.
#[test]
fn a_wrong_source_costs_less_than_ten_degrees() {
    let right = Source { every_s: 1.0, silent_s: (150.0, 180.0), ..GOOD };
    let wrong = Source { every_s: 1.0, wrong_s: (150.0, 180.0), ..GOOD };
    for seed in 1..=runs(2, 8) as u64 {
        let (right, wrong) = (run("places.car-hand", seed, Some(right)), run("places.car-hand", seed, Some(wrong)));
        let rows = right.iter().zip(&wrong).filter(|(row, _)| (150.0..190.0).contains(&row.time_s));
        let cost: Vec<f64> = rows.map(|(right, wrong)| wrong.error_deg.abs() - right.error_deg.abs()).collect();
        // 50 rows a second
        let costly = cost.iter().filter(|cost| **cost > 10.0).count();
        assert!(costly < 250, "seed {seed}: {costly} rows");
        let told = wrong.iter().filter(|row| (160.0..180.0).contains(&row.time_s));
        assert!(told.filter(|row| row.aid == Some(HeadingAid::Disagrees)).count() > 500, "seed {seed}");
    }
}
