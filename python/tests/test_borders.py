"""What is refused, with which error, and that it changes nothing."""

import copy
import datetime
import doctest
import importlib.metadata
import json
import signal
import typing

import numpy as np
import pytest

import magcomp

from conftest import ROOT


def turned(count, seed=1, noise_ut=0.5):
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return directions * 48 + [20, -30, 40] + random.normal(size=(count, 3)) * noise_ut


TIMES = np.arange(2000, dtype=np.int64) * 10_000_000


def test_the_docstring_runs():
    assert doctest.testmod(magcomp).failed == 0


def test_a_fit_finds_the_calibration_and_its_covariance_is_true():
    errors, sigmas = [], []
    for seed in range(40):
        fit = magcomp.fit_ellipsoid(turned(400, seed))
        errors.append(fit.calibration.hard_iron_ut - [20, -30, 40])
        sigmas.append(np.sqrt(np.diag(fit.covariance)[:3]))
    ratio = np.sqrt(np.mean(np.square(np.array(errors) / np.array(sigmas))))
    assert 0.8 < ratio < 1.25, ratio
    assert fit.samples == 400 and 0.3 < fit.residual_rms_ut < 0.7


def test_correct_and_distort_are_inverse():
    m = np.array([[1.1, 0.02, -0.03], [0.02, 0.95, 0.01], [-0.03, 0.01, 1.0]])
    calibration = magcomp.Calibration(m, [20, -30, 40], 48.0)
    h = turned(100)
    np.testing.assert_allclose(calibration.distort(h), h @ m.T + [20, -30, 40], atol=1e-12)
    np.testing.assert_allclose(calibration.correct(calibration.distort(h)), h, atol=1e-12)
    np.testing.assert_array_equal(calibration.soft_iron, m)


def test_lists_integers_and_strided_arrays_are_taken():
    h = np.round(turned(2000))
    expected = magcomp.Compensator().process(TIMES, h)["field_ut"]
    for times, fields in (
        (TIMES.tolist(), h.tolist()),
        (TIMES.astype(np.uint64), h.astype(np.int32)),
        (np.repeat(TIMES, 2)[::2], np.asfortranarray(h)),
        (TIMES[::-1][::-1], np.repeat(h, 2, axis=1)[:, ::2]),
        (np.ma.asarray(TIMES), np.ma.asarray(h)),
    ):
        found = magcomp.Compensator().process(times, fields)["field_ut"]
        assert np.array_equal(found, expected, equal_nan=True)


@pytest.mark.parametrize(
    "times, fields, says",
    [
        (TIMES[:5], np.zeros((4, 3)), "5 times for 4 samples"),
        (TIMES[:5] * 1e-9, np.zeros((5, 3)), "whole nanoseconds"),
        (TIMES[:4].reshape(2, 2), np.zeros((4, 3)), "whole nanoseconds"),
        (TIMES[:5], np.zeros((5, 2)), "must be \\(n, 3\\)"),
        (TIMES[:5], np.zeros(5), "must be \\(n, 3\\)"),
        (TIMES[:1], [["a", "b", "c"]], "no array of numbers"),
        (TIMES[:5], np.ma.masked_greater(np.eye(5, 3), 0.5), "field_ut has masked values"),
        (np.ma.masked_greater(TIMES[:5], 3), np.zeros((5, 3)), "time_ns has masked values"),
        (TIMES[:5].astype(np.uint64) + 2**63, np.zeros((5, 3)), "beyond 2\\^63"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_and_change_nothing(times, fields, says):
    compensator = magcomp.Compensator()
    compensator.process(TIMES, turned(2000))
    before = compensator.keep(3_500_000_000)
    with pytest.raises(magcomp.MagcompError, match=says):
        compensator.process(times, fields)
    assert compensator.keep(3_500_000_000) == before is not None


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="Windows has no timer that signals")
def test_ctrl_c_ends_a_long_recording_between_two_samples():
    def pressed(*_):
        raise KeyboardInterrupt

    compensator = magcomp.Compensator()
    times, fields = np.arange(1_000_000, dtype=np.int64) * 10_000_000, np.tile(turned(2000), (500, 1))
    before = signal.signal(signal.SIGALRM, pressed)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(KeyboardInterrupt):
            compensator.process(times, fields)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert compensator.push(0, fields[0]).status == "rejected"  # its time was taken
    assert "rejected" not in compensator.process(times[-100:], fields[-100:])["status"]


def test_a_sensor_with_other_times_than_samples_is_refused():
    with pytest.raises(magcomp.MagcompError, match="rotation_rate has 3 times and 2 samples"):
        magcomp.Compensator().process(TIMES[:3], np.zeros((3, 3)), rotation_rate=(TIMES[:3], np.zeros((2, 3))))


def test_samples_that_are_refused_say_why():
    compensator = magcomp.Compensator(rail_ut=1200.0)
    assert "not finite" in compensator.push(0, [np.nan, 0, 0]).status_text
    assert "full scale" in compensator.push(0, [1200.0, 0, 0]).status_text
    assert compensator.push(0, [30.0, 0, 0]).status == "collecting"
    assert compensator.push(0, [30.0, 0, 0]).status == "rejected"
    with pytest.raises(magcomp.EventError, match="finite"):
        compensator.push_rotation_rate(0, [np.inf, 0, 0])
    with pytest.raises(magcomp.EventError):
        compensator.push_up(0, [np.nan, 0, 0])
    with pytest.raises(magcomp.MagcompError, match="must be \\(3,\\)"):
        compensator.push(1, [1.0, 2.0])


@pytest.mark.parametrize(
    "settings, says",
    [
        ({"rail": 3.0}, "unknown field `rail`"),
        ({"rail_ut": -1.0}, "rail_ut"),
        ({"method": "Best"}, "unknown variant `Best`"),
        ({"heading": {"declination_deg": 500.0}}, "declination_deg"),
    ],
)
def test_settings_that_are_not_known_or_out_of_range_are_refused(settings, says):
    with pytest.raises(magcomp.ConfigError, match=says):
        magcomp.Compensator(**settings)


def test_settings_come_back():
    config = magcomp.Compensator(method="Adaptive", heading={"declination_deg": 3.5}).config
    assert config["method"] == "Adaptive" and config["heading"]["declination_deg"] == 3.5
    assert magcomp.Compensator(**config).config == config


def accepts(hint, wrap):
    """Each value of a Literal is taken, and one that it does not have is refused."""
    for value in typing.get_args(hint):
        magcomp.Compensator(**wrap(value))
    with pytest.raises(magcomp.ConfigError, match="unknown variant `None of these`"):
        magcomp.Compensator(**wrap("None of these"))


def test_typed_settings_are_those_that_there_are():
    config = magcomp.Compensator().config
    hints = typing.get_type_hints(magcomp.Settings)
    assert hints.keys() == config.keys()
    accepts(hints["method"], lambda value: {"method": value})
    for group in ("heading", "windowed"):
        inner = typing.get_type_hints(hints[group])
        assert inner.keys() == config[group].keys()
        literals = [name for name, hint in inner.items() if typing.get_origin(hint) is typing.Literal]
        assert len(literals) == 2
        for name in literals:
            accepts(inner[name], lambda value: {group: {name: value}})
    (initial, _) = typing.get_args(hints["initial"])
    given = {"soft_iron": [1, 0, 0, 0, 1, 0, 0, 0, 1], "hard_iron_ut": [20, -30, 40], "field_strength_ut": 48}
    assert typing.get_type_hints(initial).keys() == given.keys()
    assert magcomp.Compensator(initial=given).calibration.hard_iron_ut.tolist() == [20, -30, 40]


def test_typed_statuses_are_those_that_all_languages_have():
    known = json.loads((ROOT / "tests/vectors/statuses.json").read_text())
    assert set(typing.get_args(magcomp.Status)) == {it["label"] for it in known["statuses"]}
    assert list(typing.get_args(magcomp.EventKind)) == [it["kind"] for it in known["events"]]
    assert list(typing.get_args(magcomp.HeadingAid)) == [it["name"].lower() for it in known["heading_aids"]]


def test_points_that_no_ellipsoid_fits_are_refused():
    with pytest.raises(magcomp.FitError, match="too few"):
        magcomp.fit_ellipsoid(np.zeros((3, 3)))
    with pytest.raises(magcomp.CalibrationError):
        magcomp.Calibration(np.zeros((3, 3)), [0, 0, 0], 50.0)


def test_a_kept_calibration_is_adopted_and_a_damaged_one_is_refused():
    first = magcomp.Compensator()
    assert first.keep(3_500_000_000) is None
    first.process(TIMES, turned(2000))
    text = first.keep(3_500_000_000)
    second = magcomp.Compensator()
    second.adopt(text, 3_500_000_000)
    answer = second.process(TIMES[:3], turned(3))
    assert np.isfinite(answer["field_ut"]).all() and set(answer["status"]) == {"held"}
    with pytest.raises(magcomp.KeptError):
        second.adopt(text[:-20])
    assert np.isfinite(second.push(int(TIMES[3]), turned(4)[3]).field_ut).all()


def test_a_copy_goes_its_own_way():
    first = magcomp.Compensator()
    first.process(TIMES[:1000], turned(1000))
    second = copy.deepcopy(first)
    after = [it.process(TIMES[1000:], turned(2000)[1000:])["field_ut"] for it in (first, second)]
    assert np.array_equal(*after)
    first.reset()
    assert first.calibration is None and second.calibration is not None


def test_times_at_the_ends_of_the_clock_break_nothing():
    ends = np.array([np.iinfo(np.int64).min, -1, 0, 1, np.iinfo(np.int64).max], dtype=np.int64)
    answers = magcomp.Compensator().process(ends, turned(5), rotation_rate=(ends, np.ones((5, 3))), up=(ends, np.ones((5, 3))))
    assert len(answers["status"]) == 5


def test_the_earths_field_is_the_models():
    # published with WMM2025 by NOAA: 2025.0, height 0
    for latitude, longitude, declination, dip, total in (
        (80, 0, 1.28, 83.21, 55.179),
        (0, 120, -0.16, -14.93, 41.064),
        (-80, -120, 68.78, -72.00, 54.698),
    ):
        for date in ("2025-01-01", datetime.date(2025, 1, 1)):
            found = magcomp.earth_field(latitude, longitude, date)
            np.testing.assert_allclose(found, (total, dip, declination), atol=0.05)
    for wrong in ((91, 0, "2025-01-01"), (0, np.nan, "2025-01-01"), (0, 0, "2025-13-01"), (0, 0, "1905-01-01")):
        with pytest.raises(magcomp.PlaceError):
            magcomp.earth_field(*wrong)


def test_headings_from_outside_lead_where_the_calibration_is_hardly_known():
    """A device that lies flat and still, its top edge north by a calibration that is hardly known; an outside world is turned by 30 deg."""
    rough = magcomp.Compensator(
        initial={"soft_iron": [1, 0, 0, 0, 1, 0, 0, 0, 1], "hard_iron_ut": [0, 0, 0], "field_strength_ut": 49.244}, initial_sigma_ut=30.0
    )
    half = np.deg2rad(-15)
    for as_attitude in (True, False):
        compensator = copy.copy(rough)
        for k in range(1, 3000):
            time_ns = k * 20_000_000
            compensator.push_rotation_rate(time_ns, [0, 0, 0])
            compensator.push_up(time_ns, [0, 0, 9.81])
            if k % 50 == 0 and as_attitude:
                compensator.push_attitude(time_ns, [np.cos(half), 0, 0, np.sin(half)], north="magnetic", sigma_deg=1.0)
            elif k % 50 == 0:
                compensator.push_heading(time_ns, 30.0, 1.0, axis=[0, 1, 0])
            reading = compensator.push(time_ns, [0.2 * np.sin(1.7 * k * k), 20, -45])
        if as_attitude:
            assert compensator.heading_aid == "leads" and compensator.found_declination_deg is None
            assert abs(reading.heading_deg - 30) < 5
        else:
            # from true north: the difference may be the declination
            assert compensator.heading_aid in ("used", "leads") and compensator.found_declination_deg[1] > 0
            assert abs(reading.true_heading_deg - 30) < 5


def test_headings_from_outside_that_cannot_be_used_are_refused():
    compensator = magcomp.Compensator()
    for call, says in (
        (lambda: compensator.push_heading(1, np.nan, 5.0), "finite"),
        (lambda: compensator.push_heading(1, 90.0, 0.0), "range"),
        (lambda: compensator.push_heading(1, 90.0, 5.0, axis=[0, 0, 0]), "range"),
        (lambda: compensator.push_attitude(1, [0, 0, 0, 0]), "range"),
        (lambda: compensator.push_attitude(1, [np.inf, 0, 0, 0]), "finite"),
    ):
        with pytest.raises(magcomp.EventError, match=says):
            call()
    for call, says in (
        (lambda: compensator.push_heading(1, 90.0, 5.0, north="grid"), '"true" or "magnetic"'),
        (lambda: compensator.push_heading(1, 90.0, 5.0, axis=[1, 0]), "must be \\(3,\\)"),
        (lambda: compensator.push_attitude(1, [1, 0, 0]), "four numbers"),
        (lambda: compensator.push_attitude(1, np.eye(4)), "four numbers"),
        (lambda: compensator.push_attitude(1, [1, 0, 0, 0], north="true"), "both north and sigma_deg"),
    ):
        with pytest.raises(magcomp.MagcompError, match=says):
            call()
    compensator.push_heading(1, 90.0, 5.0)
    with pytest.raises(magcomp.EventError, match="same time"):
        compensator.push_heading(1, 90.0, 5.0)
    compensator.push_attitude(2, [3, 0, 0, 0])
    assert compensator.heading_aid is None and compensator.found_declination_deg is None


def test_the_wheel_carries_the_licences():
    files = {file.name: file for file in importlib.metadata.files("magcomp") if file.parent.name == "licenses"}
    for name, folder in [("LICENSE-MIT", ""), ("LICENSE-APACHE", ""), ("THIRD-PARTY-NOTICES", "python")]:
        assert files.pop(name).read_text() == (ROOT / folder / name).read_text()
    assert not files
