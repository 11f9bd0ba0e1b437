//! Times that are written as a date and a time of day.

const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

/// `22-Nov-2026 10:11:12.345`, `2026-11-22 10:11:12,345` or `2026-11-22T10:11:12.345+01:00`, ns since 1970; in the file's own time zone
/// where it names none.
pub(super) fn parse_ns(text: &str) -> Option<i64> {
    let (date, time) = text.trim().split_once([' ', 'T'])?;
    let parts: Vec<&str> = date.split(['-', '/']).collect();
    let [first, month, last] = parts[..] else { return None };
    let named = MONTHS.iter().position(|name| month.to_lowercase().starts_with(name)).map(|month| month as i64 + 1);
    let (year, month, day) = match named {
        Some(month) => (last.parse().ok()?, month, first.parse().ok()?),
        None => (first.parse().ok()?, month.parse().ok()?, last.parse::<i64>().ok()?),
    };
    let (time, east_s) = zone(time)?;
    let clock: Vec<&str> = time.split(':').collect();
    let [hour, minute, second] = clock[..] else { return None };
    let second = second.replace(',', ".");
    let (hour, minute, second): (i64, i64, f64) = (hour.parse().ok()?, minute.parse().ok()?, second.parse().ok()?);
    let inside =
        (1..=12).contains(&month) && (1..=31).contains(&day) && (0..24).contains(&hour) && (0..60).contains(&minute);
    let inside = inside && (0.0..61.0).contains(&second) && (1900..2100).contains(&year);
    let whole_s = ((days(year, month, day) * 24 + hour) * 60 + minute) * 60 - east_s;
    inside.then(|| whole_s * 1_000_000_000 + (second * 1e9).round() as i64)
}

/// The time of day, and how many seconds its zone is east of Greenwich: `10:11:12Z`, `10:11:12+01:00`, `10:11:12-0330`.
fn zone(time: &str) -> Option<(&str, i64)> {
    if let Some(time) = time.strip_suffix('Z') {
        return Some((time, 0));
    }
    let Some(at) = time.rfind(['+', '-']) else { return Some((time, 0)) };
    let (time, zone) = time.split_at(at);
    let (hours, minutes) = match (zone.len(), zone.as_bytes().get(3)) {
        (3, None) => (&zone[1..], "0"),
        (5, Some(_)) => (zone.get(1..3)?, zone.get(3..)?),
        (6, Some(b':')) => (zone.get(1..3)?, zone.get(4..)?),
        _ => return None,
    };
    let east_s = hours.parse::<i64>().ok()? * 3600 + minutes.parse::<i64>().ok()? * 60;
    Some((time, if zone.starts_with('-') { -east_s } else { east_s }))
}

/// Days from 1970-01-01 to this date of the Gregorian calendar, years counted from March.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    365 * year + leap_days + (153 * month + 2) / 5 + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_are_those_of_the_calendar() {
        // `date -u -d '2026-11-22 10:11:12' +%s` and so on
        for text in [
            "22-Nov-2026 10:11:12.345",
            "2026-11-22T10:11:12.345Z",
            "2026/11/22 10:11:12,345",
            "2026-11-22T11:41:12.345+01:30",
        ] {
            assert_eq!(parse_ns(text), Some(1_795_342_272_345_000_000), "{text}");
        }
        assert_eq!(parse_ns("2026-11-22T06:41:12.345-0330"), Some(1_795_342_272_345_000_000));
        assert_eq!(parse_ns("29-Feb-2024 23:59:59"), Some(1_709_251_199_000_000_000));
        assert_eq!(parse_ns("1970-01-01 00:00:00"), Some(0));
        for wrong in [
            "",
            "10:11:12",
            "2026-13-01 00:00:00",
            "22-Nov-2026",
            "2026-11-22 25:00:00",
            "22-Foo-2026 10:11:12",
            "2026-11-22T10:11:12+1:0",
        ] {
            assert_eq!(parse_ns(wrong), None, "{wrong}");
        }
    }
}
