@file:JvmName("Texts")
@file:JvmMultifileClass

package org.magcomp

import android.content.res.Resources
import kotlin.math.ceil
import kotlin.math.roundToInt
import org.magcomp.core.*

/** One sentence that an app may show of what a stream lacks, in the language of [resources]; null if it lacks nothing. */
public fun StreamStatus.text(resources: Resources): String? = when (this) {
    StreamStatus.Live -> null
    StreamStatus.NoVertical -> resources.getString(R.string.magcomp_stream_no_vertical)
    is StreamStatus.Silent -> resources.getString(
        when {
            PhoneSensor.MAGNETOMETER in sensors && sensors.size > 1 -> R.string.magcomp_stream_silent_all
            PhoneSensor.MAGNETOMETER in sensors -> R.string.magcomp_stream_silent_magnetometer
            PhoneSensor.GRAVITY in sensors -> R.string.magcomp_stream_silent_gravity
            else -> R.string.magcomp_stream_silent_gyroscope
        },
    )
}

/** One sentence that an app may show where a compass has ended with this, in the language of [resources]. The message is for the developer. */
public fun CompassException.text(resources: Resources): String =
    resources.getString(if (this is SensorException.Missing) R.string.magcomp_error_missing else R.string.magcomp_error)

/** The heading as a screen reader says it, in whole degrees, in the language of [resources]; of null, that there is none. */
public fun CompassHeading?.spoken(resources: Resources): String {
    if (this == null) return resources.getString(R.string.magcomp_spoken_no_heading)
    // 359.6 is 0
    return resources.getString(R.string.magcomp_spoken_heading, headingDeg.roundToInt() % 360, ceil(headingSigmaDeg ?: 180.0).toInt())
}
