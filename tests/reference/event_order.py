"""Events of three sensors as a system delivers them, and the order in which they must go out.

The rules, as `sensing/order.rs` documents them, applied in the plainest way: after every delivery everything that waits is sorted
anew, and the first is looked at again and again. Where every event comes less than the hold late, what goes out is the whole
stream sorted by (time, sensor); `late` says where it is not.

Kinds: 0 rotation rate, 1 up, 2 magnetic, which is also their order at equal times. Times in milliseconds.
"""

import random
from common import write

SEED = 20241123
PAUSE_MS, ANOTHER_CLOCK_MS, ROOM = 250, 10_000, 256
RATE, UP, FIELD = 0, 1, 2


def released(deliveries, hold_ms):
    """For every delivery, and for the flush at the end, the numbers of the deliveries that go out."""
    waiting, latest, begin, answers = [], {}, 0, []
    for number, (kind, time) in enumerate(deliveries):
        gone = []
        newest = max(latest.values(), default=None)
        if newest is None or time - newest > PAUSE_MS or newest - time > ANOTHER_CLOCK_MS:
            gone += [n for _, _, n in sorted(waiting)]
            waiting, latest, begin = [], {}, time
        waiting.append((time, kind, number))
        latest[kind] = time
        newest = max(latest.values())
        while waiting:
            first = min(waiting)
            holds = False
            for sensor in (RATE, UP, FIELD):
                seen = latest.get(sensor)
                lives = newest - max(begin, seen if seen is not None else begin) <= PAUSE_MS
                holds |= lives and (seen is None or seen < first[0])
            if holds and newest - first[0] < hold_ms and len(waiting) < ROOM:
                break
            waiting.remove(first)
            gone.append(first[2])
        answers.append(gone)
    answers.append([n for _, _, n in sorted(waiting)])
    return answers


def delivered(streams):
    """[(kind, times, when each is delivered)] as one list in the order of delivery; at one moment in the order given."""
    arrivals = [(when, place, time, kind) for place, (kind, times, by) in enumerate(streams) for time, when in zip(times, by)]
    return [(kind, time) for _, _, time, kind in sorted(arrivals)]


def batches(times, batch):
    """Delivered at the end of the batch they fall into."""
    return [-(-time // batch) * batch for time in times]


def plain(period, end, begin=0):
    return list(range(begin, end, period))


def case(name, hold_ms, deliveries, late=False):
    gone = released(deliveries, hold_ms)
    order = [number for step in gone for number in step]
    assert sorted(order) == list(range(len(deliveries))), name
    in_order = [(deliveries[n][1], deliveries[n][0], n) for n in order]
    assert (in_order == sorted(in_order)) is not late, name
    return {
        "name": name,
        "hold_s": hold_ms / 1000,
        "deliveries": [[kind, time * 1_000_000] for kind, time in deliveries],
        "released": gone,
    }


def main():
    rng = random.Random(SEED)
    fast, slow, field = plain(5, 300), plain(10, 300, 3), plain(10, 300, 5)
    as_they_are = [(RATE, fast, fast), (UP, slow, slow), (FIELD, field, field)]
    cases = [
        case("in order", 50, delivered(as_they_are)),
        case("equal times, the magnetometer delivered first", 50, [(k, t) for t in plain(10, 100) for k in (FIELD, UP, RATE)]),
        case("inertial events 20 ms late", 50, delivered([(RATE, fast, [t + 20 for t in fast]), (UP, slow, [t + 20 for t in slow]), as_they_are[2]])),
        case("the magnetometer 30 ms late", 50, delivered([as_they_are[0], as_they_are[1], (FIELD, field, [t + 30 for t in field])])),
        case("inertial events 60 ms late, more than the hold", 50, delivered([(RATE, fast, [t + 60 for t in fast]), (UP, slow, [t + 60 for t in slow]), as_they_are[2]]), late=True),
        case("a gyroscope alone in batches of 40 ms", 50, delivered([(RATE, fast, batches(fast, 40)), as_they_are[1], as_they_are[2]])),
        case("no hold", 0, delivered([(RATE, fast, batches(fast, 40)), as_they_are[1], as_they_are[2]]), late=True),
        case("no gyroscope", 50, delivered([as_they_are[1], as_they_are[2]])),
        case("the magnetometer alone", 50, delivered([as_they_are[2]])),
    ]
    for batch, hold in ((20, 50), (100, 120), (200, 250)):
        times = plain(10, 600)
        streams = [(kind, times, batches(times, batch)) for kind in (FIELD, RATE, UP)]
        cases.append(case(f"all in batches of {batch} ms, the magnetometer's first", hold, delivered(streams)))
    before, after = plain(10, 200), plain(10, 900)
    cases.append(case("a gyroscope that stops", 50, delivered([(RATE, before, before), (UP, after, after), (FIELD, after, after)])))
    again = [t for t in after if not 100 < t < 700]
    cases.append(case("a pause of all sensors", 50, delivered([(kind, again, again) for kind in (FIELD, UP, RATE)])))
    set_back = [(k, t + 20_000) for t in before for k in (FIELD, UP, RATE)] + [(k, t) for t in before for k in (FIELD, UP, RATE)]
    cases.append(case("a clock that is set back", 50, set_back, late=True))
    ahead = [(k, t + (5000 if (k, t) == (UP, 100) else 0)) for t in after for k in (FIELD, UP, RATE)]
    cases.append(case("one stamp 5 s ahead", 50, ahead, late=True))
    flood = [(FIELD, 0)] + [(RATE, 1 + k // 20) for k in range(300)]
    cases.append(case("more than there is room for", 250, flood))
    for number in range(6):
        streams = []
        for kind in (RATE, UP, FIELD):
            period = rng.choice([3, 5, 8, 10, 20])
            times = [t + rng.randrange(period) for t in plain(period, 400)]
            by, latest = [], 0
            for time in times:
                latest = max(latest, time + rng.randrange(40))
                by.append(latest)
            streams.append((kind, times, by))
        cases.append(case(f"random delays {number}", 50, delivered(streams)))
    about = (
        "deliveries: [kind, time_ns], kind 0 rotation rate, 1 up, 2 magnetic; released: after each delivery, and after the flush at the"
        " end, the numbers of the deliveries that go out"
    )
    write("event_order.json", "event_order.py", SEED, about, {"cases": cases})


if __name__ == "__main__":
    main()
