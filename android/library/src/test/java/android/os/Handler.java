package android.os;

import java.util.ArrayList;
import java.util.Comparator;
import java.util.List;

/** Stands in for Android's, whose looper needs the platform's native part. What is posted is done when a test lets time pass, on its thread. */
public class Handler {
    private static final class Task {
        final Looper looper;
        final Runnable what;
        final long atMs;

        Task(Looper looper, Runnable what, long atMs) {
            this.looper = looper;
            this.what = what;
            this.atMs = atMs;
        }
    }

    private static final List<Task> TASKS = new ArrayList<>();
    private static long nowMs;

    private final Looper looper;

    public Handler(Looper looper) {
        this.looper = looper;
    }

    public final Looper getLooper() {
        return looper;
    }

    public final boolean postDelayed(Runnable what, long delayMs) {
        synchronized (TASKS) {
            return TASKS.add(new Task(looper, what, nowMs + delayMs));
        }
    }

    /** Lets time pass on all threads that run. */
    public static void pass(long ms) {
        long untilMs;
        synchronized (TASKS) {
            untilMs = nowMs + ms;
        }
        while (true) {
            Task next;
            synchronized (TASKS) {
                TASKS.removeIf(it -> !HandlerThread.LOOPERS.contains(it.looper));
                next = TASKS.stream().min(Comparator.comparingLong(it -> it.atMs)).filter(it -> it.atMs <= untilMs).orElse(null);
                nowMs = next == null ? untilMs : next.atMs;
                if (next == null) return;
                TASKS.remove(next);
            }
            next.what.run();
        }
    }
}
