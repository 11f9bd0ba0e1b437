package androidx.test.runner.intent;

public class IntentStubberRegistry {
    public static IntentStubber getInstance() {
        return null;
    }

    public static boolean isLoaded() {
        return false;
    }
}
