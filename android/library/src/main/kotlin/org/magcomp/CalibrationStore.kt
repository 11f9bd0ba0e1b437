package org.magcomp

import android.content.Context
import android.content.SharedPreferences

/**
 * Where a calibration is kept from one launch to the next. A store need not look into the text, which carries its own
 * version and checksum: the library ignores an old or damaged text. An error of the store appears in
 * [CompensatedReading.storeError] and harms no reading; the next save tries again.
 */
public interface CalibrationStore {
    /** The text that was saved last, or null. Never called before a save that is under way has returned. */
    public fun load(): String?

    /**
     * Keeps a snapshot in the place of the one before. Called on a background thread, one call at a time: when the
     * status is first `Tracking`, then when the calibration has changed and 10 s have passed since the save before,
     * when the last collector leaves, and at the end of the readings. A change of hard iron or soft iron counts. A
     * change of the field strength alone does not, because it follows the noise of a device at rest. Never called when
     * [load] or the save before has kept the same.
     */
    public fun save(snapshot: String)
}

/**
 * Keeps the calibration in shared preferences.
 *
 * @param preferences where
 * @param key under which key
 */
public class PreferencesStore @JvmOverloads constructor(
    private val preferences: SharedPreferences,
    private val key: String = "calibration",
) : CalibrationStore {
    /** The preferences named `org.magcomp` of an app. */
    public constructor(context: Context) : this(context.getSharedPreferences("org.magcomp", Context.MODE_PRIVATE))

    override fun load(): String? = preferences.getString(key, null)

    override fun save(snapshot: String) {
        preferences.edit().putString(key, snapshot).apply()
    }
}
