package android.os;

/** Stands in for Android's, which asks the platform: as much as the library asks. Of Android 15 until a test says otherwise. */
public class Build {
    public static final String MANUFACTURER = "MAKER";
    public static final String MODEL = "MODEL";

    public static class VERSION {
        public static int SDK_INT = 35;
        public static final String RELEASE = "15";
    }
}
