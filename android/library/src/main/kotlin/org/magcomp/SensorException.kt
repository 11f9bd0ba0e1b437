package org.magcomp

/** The phone's sensors can't be used as asked. The message tells the developer what to do. */
public sealed class SensorException(message: String, cause: Throwable? = null) : CompassException(message, cause) {
    /**
     * The phone has no such sensor.
     *
     * @property sensor its name
     */
    public class Missing(public val sensor: String, advice: String) : SensorException("this phone has no $sensor; $advice")

    /**
     * A permission is missing.
     *
     * @property permission its name in the manifest
     */
    public class PermissionMissing(public val permission: String, cause: Throwable? = null) :
        SensorException("above 200 Hz the manifest needs <uses-permission android:name=\"$permission\"/>; or ask for 200 Hz", cause)

    /**
     * The system refused to deliver a sensor's events, for instance because the app has 128 sensor listeners already.
     *
     * @property sensor its name
     * @property reason what the system said, if it said anything
     */
    public class Refused @JvmOverloads constructor(
        public val sensor: String,
        public val reason: String? = null,
        cause: Throwable? = null,
        advice: String = "end other uses of the sensors and try again",
    ) : SensorException(
        "the system refused to deliver the $sensor" + (reason?.let { " ($it)" } ?: "") + "; $advice",
        cause,
    )

    /**
     * A collector of [MagneticFieldSource.samples] has taken none for a minute. The sensors and all other collectors go on.
     *
     * @property events how many wait
     */
    public class NotTaken(public val events: Int) :
        SensorException("$events events of the sensors wait for a collector that takes none; take them faster, or write them to a file")
}
