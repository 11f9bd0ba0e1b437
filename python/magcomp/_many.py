"""Many recordings at once."""

from __future__ import annotations

import os
import sys
import typing
from collections.abc import Callable, Iterable, Mapping

from . import _magcomp
from ._frames import from_frame
from ._settings import Settings
from ._types import Session

if typing.TYPE_CHECKING:
    import pandas
    import pyarrow
    from typing_extensions import Unpack

    Recording: typing.TypeAlias = typing.Union[str, os.PathLike[str], Session, pandas.DataFrame, pyarrow.Table]


def _input(recording: object) -> object:
    """A path or a session as it is, a table as a session; what is wrong with it becomes that recording's error."""
    if isinstance(recording, (str, os.PathLike, dict)):
        return recording
    try:
        frame = recording.to_pandas() if hasattr(recording, "to_pandas") else recording
        return from_frame(frame)  # type: ignore[arg-type]
    except (AttributeError, TypeError):
        return _magcomp.MagcompError(f"it is a {type(recording).__name__}; it must be a path, a session or a table")
    except (ValueError, ImportError) as error:
        return _magcomp.MagcompError(str(error))


def _print(done: int, total: int, failed: int) -> None:
    if sys.stderr.isatty() or done == total:
        end = "\n" if done == total else ""
        print(f"\r{done} of {total} recordings, {failed} errors", end=end, file=sys.stderr, flush=True)


def process_many(
    recordings: Iterable[Recording] | Mapping[str, Recording],
    *,
    workers: int | None = None,
    progress: bool | Callable[[int, int, int], object] = True,
    results: str | os.PathLike[str] | None = None,
    **settings: Unpack[Settings],
) -> _magcomp.Many:
    """Answers each recording by itself, with a new `Compensator` of these settings, on all cores.

    A recording is a path as for `read_session`, a session, or a table as for `from_frame`. Its name in the column ``recording`` is the path, the
    key of a mapping, or its number. One that cannot be read or answered ends nothing: `Many.errors` says why. `workers` are threads, usually one
    a core, which need no lock of Python's. `progress` prints a line on standard error, or is called with how many are done, how many there are,
    and how many failed. Ctrl-C ends it within a second. Answers are written into the folder `results`, a file of Arrow each, as soon as they are
    there; a later call takes those whose recording, settings and version are the same. Raises `MagcompError` and `ConfigError`.
    """
    if isinstance(recordings, (str, os.PathLike)) or (isinstance(recordings, Mapping) and "time_ns" in recordings):
        why = "process_many needs a list of recordings, or a mapping of names to them; all in a folder are sorted(pathlib.Path(folder).iterdir())"
        raise _magcomp.MagcompError(why)
    if workers is not None and workers < 1:
        raise _magcomp.MagcompError(f"workers is {workers}; it must be 1 or more")
    if isinstance(recordings, Mapping):
        named = [(str(name), _input(recording)) for name, recording in recordings.items()]
    else:
        named = [
            (os.fspath(it) if isinstance(it, (str, os.PathLike)) else str(number), _input(it)) for number, it in enumerate(recordings)
        ]
    names = [name for name, _ in named]
    if len(set(names)) < len(names):
        twice = next(name for k, name in enumerate(names) if name in names[:k])
        raise _magcomp.MagcompError(f"{twice} is there twice; a mapping gives recordings names of their own")
    shown = _print if progress is True else progress or None
    # what Python may use, where it can tell (3.13)
    cores = getattr(os, "process_cpu_count", os.cpu_count)()
    return _magcomp._process_many(named, settings, workers or cores or 1, results, shown)


def table(recordings: Iterable[str], settings: Settings) -> pyarrow.Table:
    """For engines, whose tasks have a core each: answers with a column ``error``, which is all that a recording with an error has."""
    import pyarrow

    many = process_many(recordings, workers=1, progress=False, **settings)
    answers = pyarrow.table(many)
    for name in ("recording", "status"):
        answers = answers.set_column(answers.column_names.index(name), name, answers[name].cast(pyarrow.string()))
    answers = answers.append_column("error", pyarrow.nulls(len(answers), pyarrow.string()))
    failed = {"recording": list(many.errors), "error": list(many.errors.values())}
    errors = pyarrow.table(failed, schema=pyarrow.schema([answers.schema.field(name) for name in failed]))
    return pyarrow.concat_tables([answers, errors], promote_options="default")
