package androidx.test.runner.lifecycle;

public class ActivityLifecycleMonitorRegistry {
    private static ActivityLifecycleMonitor registered;

    public static ActivityLifecycleMonitor getInstance() {
        return registered;
    }

    public static void registerInstance(ActivityLifecycleMonitor monitor) {
        registered = monitor;
    }
}
