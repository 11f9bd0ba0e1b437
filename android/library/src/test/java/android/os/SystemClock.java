package android.os;

/** Stands in for Android's, which asks the platform: `ApplicationInfo` notes when it was made. */
public class SystemClock {
    public static long uptimeMillis() {
        return 0;
    }

    public static long elapsedRealtimeNanos() {
        return 0;
    }
}
