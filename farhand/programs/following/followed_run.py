"""A run that is followed while it goes on: the ticks of one operator's program, in order, with the gaps told."""

from collections.abc import Callable, Sequence

import msgspec

from farhand.common.messages.camera import CameraFrame
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.fates import FateBatch
from farhand.common.recording.records import Gap, RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.programs.following.tick_sources import Sources

TOO_LATE = "the operator's program keeps them no more: they were not asked for in time"


class FollowedRun:
    """Puts batches of ticks where they go.

    Args:
        begin: makes that, once the first batch tells what run it is.

    Attributes:
        next, next_fate: numbers of the first tick and fate that are not in it.
        fates: how many are in it.
        missing_fates: that an emulator kept no more.
        elsewhere: the emulator answers, and no command of this run came by it.
        first: number of the first tick that is.
        written: number after the last tick that was written; None where there is none, or the last try failed.
        done: nothing more will come.
        whole: the operator's program said itself that this was all.
        file: None until the first batch.
    """

    def __init__(self, begin: Callable[[RunInfo], RunFile]) -> None:
        self.next = self.first = 0
        self.written: int | None = None
        self.done = self.whole = False
        self.file: RunFile | None = None
        self.next_fate = self.fates = self.missing_fates = 0
        self.elsewhere = False
        self._first_ns: int | None = None  # of the first tick, by the operator's clock
        self._from_ns: int | None = None  # the same by the emulator's
        self._begin_file = begin
        self._session = self._netem = 0
        self._last_ns = 0

    def take(self, batch: TickBatch) -> None:
        """Take a batch; raises RunFileError where the file cannot be begun."""
        if self.file is None:
            self._begin(batch)
        if batch.info.session != self._session:  # it was started anew: that is another run
            self.done = True
            return
        assert self.file is not None
        missed = self.file.missing
        for tick in batch.ticks:
            if tick.number > self.next:
                self.file.gap(
                    Gap(
                        ticks=tick.number - self.next,
                        first_ns=self._last_ns,
                        last_ns=tick.now_ns,
                        why=TOO_LATE,
                    )
                )
            if self._first_ns is None:
                self._first_ns = tick.now_ns
            if tick.number >= self.next:
                self.file.tick(tick)
                self.next, self._last_ns = tick.number + 1, tick.now_ns
        if not batch.more:
            self.file.flush()
            self.written = self.next if self.file.missing == missed and batch.ticks else None
        self.done = self.whole = batch.ended

    def take_frames(self, frames: Sequence[tuple[int, CameraFrame]]) -> None:
        """Take pictures, each with its time of day (ns since 1970); those before the run's first tick are left out."""
        if self.file is None:
            return
        for at_ns, frame in frames:
            self.file.frame(frame, at_ns)

    def take_all_fates(self, sources: Sources) -> None:
        """Ask for what became of messages until there is no more."""
        more = True
        while more:
            fates = sources.fates(self.next_fate)
            if fates is None:
                return
            more = self.take_fates(fates) and fates.more

    def take_fates(self, batch: FateBatch) -> bool:
        """Take what became of messages since the run's first tick; returns False where it is not to be had yet.

        An emulator outlives runs: what it knows of others, and of the idle time between, is left out. The two clocks
        are held together by the first command of the operator's session that came by.
        """
        if self.file is None or batch.session != (self._netem or batch.session):
            return False
        if self._from_ns is None:
            offset_ns = batch.sessions_ns.get(self._session)
            self.elsewhere = offset_ns is None
            if offset_ns is None or self._first_ns is None:
                return False
            self._from_ns = self._first_ns + offset_ns
        self._netem = batch.session
        of_run = [fate for fate in batch.fates if fate.arrived_ns >= self._from_ns]
        for fate in of_run:
            self.file.fate(fate, batch.epoch_ns)
        if self.fates or len(of_run) == len(batch.fates):  # else what is not kept was before the run
            self.missing_fates += batch.first - self.next_fate
        self.fates += len(of_run)
        self.next_fate = batch.first + len(batch.fates)
        return True

    def close(self) -> None:
        """Finish the file."""
        self.done = True
        if self.file is not None:
            self.file.close()

    def _begin(self, batch: TickBatch) -> None:
        first = batch.ticks[0].number if batch.ticks else 0
        info = msgspec.structs.replace(batch.info, first_tick=first)
        self.file = self._begin_file(info)
        self._session, self.next, self.first = info.session, first, first
