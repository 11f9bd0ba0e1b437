"""What a type checker says of a program that uses magcomp: tests/python.sh has mypy read it, and an `ignore` that is not needed is an error."""

import magcomp

settings: magcomp.Settings = {"method": "Adaptive", "heading": {"axis": "Auto", "declination_deg": 2.5}}
compensator = magcomp.Compensator(**settings)
magcomp.Compensator(rail_ut=1200.0, windowed={"n_min": 50})
magcomp.Compensator(rail=1200.0)  # type: ignore[call-arg]
magcomp.Compensator(method="Best")  # type: ignore[arg-type]
magcomp.Compensator(heading={"axis": "Left"})  # type: ignore[typeddict-item]
magcomp.Compensator(heading={"declination": 2.5})  # type: ignore[typeddict-unknown-key]
magcomp.process_many([], method="Windowed")
magcomp.process_many([], methods="Windowed")  # type: ignore[call-arg]
compensator.push_heading(0, 90.0, 5.0, north="grid")  # type: ignore[arg-type]
reading = compensator.push(0, [20.0, 0.0, 40.0])
assert reading.status != "held"
assert reading.status != "hold"  # type: ignore[comparison-overlap]
