package androidx.test.platform.app;

import android.app.Instrumentation;
import android.os.Bundle;

public class InstrumentationRegistry {
    private static Instrumentation registered;

    public static void registerInstance(Instrumentation instance, Bundle arguments) {
        registered = instance;
    }

    public static Instrumentation getInstrumentation() {
        return registered;
    }
}
