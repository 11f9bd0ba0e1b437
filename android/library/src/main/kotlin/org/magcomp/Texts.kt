@file:JvmName("Texts")

package org.magcomp

import android.content.res.Resources
import kotlin.math.ceil
import kotlin.math.roundToInt
import org.magcomp.core.*

/**
 * One sentence that an app may show, in the language of [resources]. An app translates or rewords it with a string resource of the same
 * name. In English it is the sentence of `text()`, without a call into the native library.
 */
public fun CompensationStatus.text(resources: Resources): String = text(resources::getString)

/** One sentence an app may show of a change that was decided, in the language of [resources]. */
public fun FieldEvent.text(resources: Resources): String = text(resources::getString)

/** One sentence that an app may show of what a stream lacks, in the language of [resources]; null if it lacks nothing. */
public fun StreamStatus.text(resources: Resources): String? = text(resources::getString)

/** What the user can do for a better heading, in the language of [resources]; null if there is nothing to do. */
public fun CompensationStatus.guidance(resources: Resources): String? = guidance()?.let(resources::getString)

/** One sentence an app may show of what headings from outside are worth, in the language of [resources]. */
public fun HeadingAid.text(resources: Resources): String = text(resources::getString)

/** One sentence that an app may show where a compass has ended with this, in the language of [resources]. The message is for the developer. */
public fun CompassException.text(resources: Resources): String =
    resources.getString(if (this is SensorException.Missing) R.string.magcomp_error_missing else R.string.magcomp_error)

/** The heading as a screen reader says it, in whole degrees, in the language of [resources]; of null, that there is none. */
public fun CompassHeading?.spoken(resources: Resources): String = spoken(resources::getString)

/** A string resource with its placeholders filled. */
internal typealias Strings = (id: Int, values: Array<out Any>) -> String

internal fun StreamStatus.text(strings: Strings): String? = when (this) {
    StreamStatus.Live -> null
    StreamStatus.NoVertical -> strings.say(R.string.magcomp_stream_no_vertical)
    is StreamStatus.Silent -> strings.say(
        when {
            PhoneSensor.MAGNETOMETER in sensors && sensors.size > 1 -> R.string.magcomp_stream_silent_all
            PhoneSensor.MAGNETOMETER in sensors -> R.string.magcomp_stream_silent_magnetometer
            PhoneSensor.GRAVITY in sensors -> R.string.magcomp_stream_silent_gravity
            else -> R.string.magcomp_stream_silent_gyroscope
        },
    )
}

internal fun CompassHeading?.spoken(strings: Strings): String {
    if (this == null) return strings.say(R.string.magcomp_spoken_no_heading)
    // 359.6 is 0
    return strings.say(R.string.magcomp_spoken_heading, headingDeg.roundToInt() % 360, ceil(headingSigmaDeg ?: 180.0).toInt())
}

internal fun Strings.say(id: Int, vararg values: Any): String = this(id, values)
