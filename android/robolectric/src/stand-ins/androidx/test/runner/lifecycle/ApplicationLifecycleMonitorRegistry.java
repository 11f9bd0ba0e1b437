package androidx.test.runner.lifecycle;

public class ApplicationLifecycleMonitorRegistry {
    public static void registerInstance(ApplicationLifecycleMonitor monitor) { }
}
