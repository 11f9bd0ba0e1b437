//! The order of a sensor's events in time: where a session ends and the next begins, events that came late, times that were rounded,
//! events that would be lost, and how loss is told.

use super::stream::Stream;
use crate::error::RecordingError;
use std::ops::Range;

/// Time that runs back by more than a batch of events ends a session, ns.
const BATCH_NS: i64 = 1_000_000_000;
/// Events that must follow such a step back, all of them before the latest time: fewer came late.
const FOLLOWING: usize = 10;
/// Loss of a larger share is a warning, of most of a sensor an error. So few events are none.
const LOUD: f64 = 0.05;
const MOST: f64 = 0.5;
const FEWEST: usize = 5;
/// Times are rounded where this share of the steps between different times is the same power of ten.
const ROUNDED: f64 = 0.8;

/// The sessions that a sensor's events are of, in the file's order: one where their time never runs back by more than a batch, or where
/// the parts join without a gap, as those of a memory that is written round.
pub(super) fn sessions<T>(events: &[(i64, T)]) -> Vec<Range<usize>> {
    let Some((first_ns, _)) = events.first() else { return Vec::new() };
    let (mut parts, mut begin, mut latest_ns) = (Vec::new(), 0, *first_ns);
    for (k, (time_ns, _)) in events.iter().enumerate() {
        let is_back = || events[k..].iter().take(FOLLOWING).all(|(time_ns, _)| *time_ns < latest_ns);
        if *time_ns < latest_ns - BATCH_NS && is_back() {
            parts.push(begin..k);
            (begin, latest_ns) = (k, *time_ns);
        }
        latest_ns = latest_ns.max(*time_ns);
    }
    parts.push(begin..events.len());
    let mut spans: Vec<(i64, i64)> = parts.iter().map(|part| span(&events[part.clone()])).collect();
    spans.sort_unstable();
    let joined = spans.windows(2).all(|pair| (0..=BATCH_NS).contains(&(pair[1].0 - pair[0].1)));
    if joined { std::iter::once(0..events.len()).collect() } else { parts }
}

fn span<T>(events: &[(i64, T)]) -> (i64, i64) {
    let times = || events.iter().map(|(time_ns, _)| *time_ns);
    (times().min().unwrap_or(0), times().max().unwrap_or(0))
}

/// What became of a sensor's events when they were put in order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Order {
    events: usize,
    /// Came after a later one, and were put in their place.
    late: usize,
    /// Repeated time and value of another: nothing was lost.
    repeated: usize,
    /// Were left out, because another one with another value has their time.
    lost: usize,
    /// Share a time that was rounded to so many ns, and were spread over it.
    spread: Option<(usize, i64)>,
}

impl Order {
    fn percent(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.events.max(1) as f64
    }

    fn is_loud(&self, count: usize, share: f64) -> bool {
        count >= FEWEST && self.percent(count) > 100.0 * share
    }
}

/// Notes and warnings about what became of the sensors' events, of each kind one for all sensors.
///
/// # Errors
/// [`RecordingError::Usage`] where most of a sensor's events would be lost, unless that is wanted.
pub(super) fn tell(
    orders: &[(&str, Order)],
    force: bool,
    notes: &mut Vec<String>,
    warnings: &mut Vec<String>,
) -> Result<(), RecordingError> {
    type Count = fn(&Order) -> usize;
    // from the least share to the largest, of the sensors that a sentence is about
    let shares = |of: &[(&str, Order)], count: Count| {
        let percents = of.iter().map(|(_, order)| order.percent(count(order)));
        let (low, high) = percents.fold((f64::MAX, 0.0_f64), |(low, high), it| (low.min(it), high.max(it)));
        if high - low < 1.0 { format!("{high:.0} %") } else { format!("{low:.0} to {high:.0} %") }
    };
    let listed = |of: &[(&str, Order)]| of.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let counted = |(name, order): &(&str, Order), count: Count| format!("{name} {}", count(order));
    let rounded: Vec<(&str, Order)> = orders.iter().copied().filter(|(_, order)| order.spread.is_some()).collect();
    if let Some(step_ns) = rounded.iter().filter_map(|(_, order)| Some(order.spread?.1)).max() {
        let share = shares(&rounded, |order| order.spread.map_or(0, |(count, _)| count));
        warnings.push(format!(
            "{}: the times are rounded to {} s: {share} of the events shared theirs with others and were spread evenly over it; save the times with \
             more digits (a spreadsheet rounds them)",
            listed(&rounded),
            step_ns as f64 / 1e9
        ));
    }
    let kinds: [(Count, &str, &str); 3] = [
        (
            |order| order.late,
            "were older than the one before; all were put in order",
            "write each with the sensor's own time",
        ),
        (|order| order.repeated, "repeated the time of another and were left out", "they repeated its value too"),
        (
            |order| order.lost,
            "had the time of another with another value and were left out",
            "are two sensors in one file, or are the times those of arrival?",
        ),
    ];
    for (k, (count, what, more)) in kinds.into_iter().enumerate() {
        if let Some((name, order)) =
            orders.iter().find(|(_, order)| k == 2 && !force && order.is_loud(count(order), MOST))
        {
            let (lost, share, all) = (count(order), order.percent(count(order)), order.events);
            let why = format!("{name}: {lost} events {what}: {share:.0} % of {all}; {more} --force takes what is left");
            return Err(RecordingError::Usage(why));
        }
        let (loud, quiet): (Vec<_>, Vec<_>) = (orders.iter().copied())
            .filter(|(_, order)| count(order) > 0)
            .partition(|(_, order)| order.is_loud(count(order), LOUD));
        if !loud.is_empty() {
            warnings.push(format!("{}: {} of the events {what}; {more}", listed(&loud), shares(&loud, count)));
        }
        if !quiet.is_empty() {
            let counts: Vec<String> = quiet.iter().map(|it| counted(it, count)).collect();
            notes.push(format!("{} events {what}", counts.join(", ")));
        }
    }
    Ok(())
}

impl<T: PartialEq> Stream<T> {
    /// In the order of time, one event for each, each value changed by `change`.
    pub fn order(&mut self, change: impl Fn(&mut T)) -> Order {
        let events = &mut self.events;
        events.iter_mut().for_each(|(_, value)| change(value));
        let late = events.windows(2).filter(|pair| pair[1].0 < pair[0].0).count();
        events.sort_by_key(|(time_ns, _)| *time_ns);
        let count = events.len();
        events.dedup_by(|next, before| next.0 == before.0 && next.1 == before.1);
        let mut order = Order { events: count, late, repeated: count - events.len(), ..Order::default() };
        let ties = events.windows(2).filter(|pair| pair[0].0 == pair[1].0).count();
        if ties == 0 {
            return order;
        }
        let is_common = ties >= FEWEST && ties as f64 > LOUD * count as f64;
        if let Some(step_ns) = rounded_to(events).filter(|_| is_common) {
            order.spread = Some((spread(events), step_ns));
        }
        let before = events.len();
        events.dedup_by_key(|(time_ns, _)| *time_ns);
        order.lost = before - events.len();
        order
    }
}

/// The power of ten that most steps from a time that several events share are, ns.
fn rounded_to<T>(events: &[(i64, T)]) -> Option<i64> {
    let groups: Vec<&[(i64, T)]> = events.chunk_by(|a, b| a.0 == b.0).collect();
    let shared = groups.windows(2).filter(|pair| pair[0].len() > 1);
    let mut steps: Vec<i64> = shared.map(|pair| pair[1][0].0 - pair[0][0].0).collect();
    steps.sort_unstable();
    let usual_ns = *steps.get(steps.len() / 2)?;
    let is_power = (0..=10).any(|power| 10_i64.pow(power) == usual_ns);
    let alike = steps.iter().filter(|step| **step == usual_ns).count() as f64;
    (is_power && alike >= ROUNDED * steps.len() as f64).then_some(usual_ns)
}

/// Spreads events of one time evenly between the middles of the steps to the times before and after; how many there are.
fn spread<T>(events: &mut [(i64, T)]) -> usize {
    let groups: Vec<(i64, usize)> = events.chunk_by(|a, b| a.0 == b.0).map(|group| (group[0].0, group.len())).collect();
    let (mut begin, mut moved) = (0, 0);
    for (k, (time_ns, count)) in groups.iter().enumerate() {
        let other = |k: Option<usize>| k.and_then(|k| groups.get(k));
        let (before, after) = (other(k.checked_sub(1)), other(Some(k + 1)));
        let half_ns = |other: &(i64, usize)| (other.0 - time_ns).abs() as f64 / 2.0;
        // at an end, as dense as the group beside it
        let (start_ns, step_ns) = match (before.map(half_ns), after.map(half_ns)) {
            (Some(half_before), Some(half_after)) => (-half_before, (half_before + half_after) / *count as f64),
            (Some(half), None) => (-half, 2.0 * half / before.map_or(1, |it| it.1).max(*count) as f64),
            (None, Some(half)) => {
                let step = 2.0 * half / after.map_or(1, |it| it.1).max(*count) as f64;
                (half - step * *count as f64, step)
            }
            (None, None) => (0.0, 0.0),
        };
        if *count > 1 {
            moved += count;
            for (i, event) in events[begin..begin + count].iter_mut().enumerate() {
                event.0 = time_ns + (start_ns + (i as f64 + 0.5) * step_ns) as i64;
            }
        }
        begin += count;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(times_ms: impl IntoIterator<Item = i64>) -> Stream<usize> {
        let events = times_ms.into_iter().enumerate().map(|(k, ms)| (ms * 1_000_000, k)).collect();
        Stream { events, ..Stream::default() }
    }

    fn told(order: Order, force: bool) -> Result<[Vec<String>; 2], String> {
        let (mut notes, mut warnings) = (Vec::new(), Vec::new());
        tell(&[("gyroscope", order)], force, &mut notes, &mut warnings).map_err(|why| why.to_string())?;
        Ok([notes, warnings])
    }

    #[test]
    fn time_that_runs_back_ends_a_session_and_a_late_event_does_not() {
        let found = |times: Vec<i64>| {
            let parts = sessions(&stream(times.into_iter().map(|k| 100 * k)).events);
            parts.iter().map(|part| (part.start, part.end)).collect::<Vec<_>>()
        };
        assert_eq!(found((0..100).collect()), [(0, 100)]);
        // back by four seconds, for good; by half a second; one event alone; a memory that is written round, whole and with a gap
        assert_eq!(found((0..60).chain(20..90).collect()), [(0, 60), (60, 130)]);
        assert_eq!(found((0..60).chain(55..90).collect()), [(0, 95)]);
        assert_eq!(found((0..60).chain([20]).chain(60..90).collect()), [(0, 91)]);
        assert_eq!(found((60..90).chain(0..60).collect()), [(0, 90)]);
        assert_eq!(found((75..95).chain(0..50).collect()), [(0, 20), (20, 70)]);
        assert!(found(Vec::new()).is_empty());
    }

    #[test]
    fn rounded_times_are_spread_evenly_and_told() {
        // 50 Hz; from 10 s on three digits are tenths of a second
        let rounded = |k: i64| if k < 500 { 20 * k } else { (20 * k + 50) / 100 * 100 };
        let mut stream = stream((0..1500).map(rounded));
        let order = stream.order(|_| ());
        assert_eq!((order.lost, order.repeated, stream.events.len()), (0, 0, 1500));
        let off_ms = stream.events.iter().map(|(time_ns, k)| time_ns / 1_000_000 - 20 * *k as i64);
        let worst = off_ms.map(i64::abs).max().unwrap();
        assert!(worst <= 20, "{worst}");
        assert!(stream.events.windows(2).all(|pair| pair[0].0 < pair[1].0));
        let [notes, warnings] = told(order, false).unwrap();
        assert!(notes.is_empty() && warnings[0].contains("rounded to 0.1 s: 67 % of the events"), "{warnings:?}");
    }

    #[test]
    fn loss_is_a_note_a_warning_or_an_error_by_its_share() {
        let shared =
            |from: i64| stream((0..100).flat_map(move |k| std::iter::repeat_n(7 * k, if k >= from { 2 } else { 1 })));
        let [notes, warnings] = told(shared(97).order(|_| ()), false).unwrap();
        assert!(warnings.is_empty() && notes[0].contains("gyroscope 3 events had the time of another"), "{notes:?}");
        let [notes, warnings] = told(shared(80).order(|_| ()), false).unwrap();
        assert!(
            notes.is_empty() && warnings[0].starts_with("gyroscope: 17 % of the events had the time of another"),
            "{warnings:?}"
        );
        let mut thrice = stream((0..100).flat_map(|k| std::iter::repeat_n(7 * k, 3)));
        let order = thrice.order(|_| ());
        assert!(told(order, false).unwrap_err().contains("--force") && told(order, true).is_ok());
        // repeated with its value: nothing is lost
        let mut same = Stream { events: (0..100).map(|k| (k / 2 * 7, k / 2)).collect(), ..Stream::default() };
        let order = same.order(|_| ());
        assert_eq!((order.repeated, order.lost, same.events.len()), (50, 0, 50));
        let [_, warnings] = told(order, false).unwrap();
        assert!(warnings[0].contains("50 % of the events repeated"), "{warnings:?}");
    }

    #[test]
    fn one_sentence_is_about_all_sensors() {
        let shared = |count: i64| {
            let times = (0..100).flat_map(move |k| std::iter::repeat_n(7 * k, if k >= 100 - count { 2 } else { 1 }));
            stream(times).order(|_| ())
        };
        let (mut notes, mut warnings) = (Vec::new(), Vec::new());
        let orders = [("magnetometer", shared(20)), ("accelerometer", shared(50)), ("gyroscope", shared(2))];
        tell(&orders, false, &mut notes, &mut warnings).unwrap();
        assert!(
            warnings.len() == 1 && warnings[0].starts_with("magnetometer, accelerometer: 17 to 33 % of"),
            "{warnings:?}"
        );
        assert!(notes.len() == 1 && notes[0].starts_with("gyroscope 2 events"), "{notes:?}");
    }
}
