package androidx.test.runner.intent;

public class IntentMonitorRegistry {
    public static void registerInstance(IntentMonitor monitor) { }
}
