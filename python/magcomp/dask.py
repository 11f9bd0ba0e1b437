"""`process_many` on Dask."""

from __future__ import annotations

import typing

from ._many import table

if typing.TYPE_CHECKING:
    import dask.dataframe
    import pandas
    from typing_extensions import Unpack

    from ._settings import Settings


def process_many(recordings: dask.dataframe.DataFrame, **settings: Unpack[Settings]) -> dask.dataframe.DataFrame:
    """The answers for paths in the column ``recording``, which every worker can open, with a column ``error`` of those that have none. A
    partition is a task and is answered whole: ``dask.dataframe.from_pandas(paths, npartitions=200)``."""

    def answers(paths: pandas.DataFrame) -> pandas.DataFrame:
        found: pandas.DataFrame = table(paths["recording"].tolist(), settings).to_pandas()
        return found

    answered: dask.dataframe.DataFrame = recordings.map_partitions(answers, meta=table([], settings).to_pandas())
    return answered
