"""Events of two topics in the order of their stamps."""

import bisect


class Order:
    """Holds events until both topics have come as far, or one has gone `hold_ns` ahead: the other is silent, or too late."""

    def __init__(self, hold_ns):
        self._hold_ns = hold_ns
        self._waiting = []  # (time_ns, topic, event): of one time the IMU's comes first
        self._latest = {}

    def add(self, topic, time_ns, event):
        """Takes an event; returns those, as (topic, time_ns, event), whose turn it is."""
        bisect.insort(self._waiting, (time_ns, topic, event), key=lambda it: it[:2])
        self._latest[topic] = max(time_ns, self._latest.get(topic, time_ns))
        latest = max(self._latest.values())
        until = min(self._latest.values()) if len(self._latest) == 2 else latest - self._hold_ns
        until = max(until, latest - self._hold_ns)
        count = bisect.bisect_right(self._waiting, until, key=lambda it: it[0])
        ready, self._waiting = self._waiting[:count], self._waiting[count:]
        return [(topic, time_ns, event) for time_ns, topic, event in ready]
