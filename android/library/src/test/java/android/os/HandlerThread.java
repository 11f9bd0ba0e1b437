package android.os;

import java.lang.reflect.Field;
import java.util.Set;
import java.util.concurrent.ConcurrentHashMap;
import java.util.concurrent.atomic.AtomicInteger;

/** Stands in for Android's, whose looper needs the platform's native part. The events of a test come on its own thread. */
public class HandlerThread {
    /** Threads that were started and have not been told to quit. */
    public static final AtomicInteger RUNNING = new AtomicInteger();

    /** Loopers of those. */
    public static final Set<Looper> LOOPERS = ConcurrentHashMap.newKeySet();

    private Looper looper;

    public HandlerThread(String name) { }

    public void start() {
        RUNNING.incrementAndGet();
        looper = made();
        LOOPERS.add(looper);
    }

    public Looper getLooper() {
        return looper;
    }

    private static Looper made() {
        try {
            Field unsafe = Class.forName("sun.misc.Unsafe").getDeclaredField("theUnsafe");
            unsafe.setAccessible(true);
            Object made = unsafe.get(null);
            return (Looper) made.getClass().getMethod("allocateInstance", Class.class).invoke(made, Looper.class);
        } catch (ReflectiveOperationException e) {
            throw new AssertionError(e);
        }
    }

    public boolean quitSafely() {
        LOOPERS.remove(looper);
        return RUNNING.getAndDecrement() > 0;
    }
}
