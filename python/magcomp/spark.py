"""`process_many` on Spark."""

from __future__ import annotations

import typing

from ._many import table

if typing.TYPE_CHECKING:
    from collections.abc import Iterator

    import pyarrow
    from pyspark.sql import DataFrame
    from typing_extensions import Unpack

    from ._settings import Settings


def process_many(recordings: DataFrame, **settings: Unpack[Settings]) -> DataFrame:
    """The answers for paths in the column ``recording``, which every worker can open, with a column ``error`` of those that have none. Spread
    the paths over as many partitions as there are tasks to run: ``recordings.repartition(200)``."""

    def answers(batches: Iterator[pyarrow.RecordBatch]) -> Iterator[pyarrow.RecordBatch]:
        for batch in batches:
            for path in batch.column("recording").to_pylist():
                yield from table([path], settings).to_batches()

    return recordings.mapInArrow(answers, SCHEMA)


SCHEMA = "recording string, time_ns bigint, " + "".join(
    f"{name} double, "
    for name in (
        *(f"{stem}_{axis}_ut" for stem in ("field", "filtered_field") for axis in "xyz"),
        *("field_sigma_ut", "heading_deg", "heading_sigma_deg", "true_heading_deg", "direction_sigma_deg"),
    )
) + "status string, error string"
