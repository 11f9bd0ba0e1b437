package org.magcomp

import android.content.Context
import android.content.SharedPreferences

/**
 * Keeps a calibration from one launch to the next. The text is JSON with its version, source, date and covariance; a store need not look
 * into it. The compass takes over nothing of a text that is damaged or of a newer version, and [CompensatedReading.storeError] says so. It
 * also tells an error of the store, which harms no reading; the next save tries again.
 */
public interface CalibrationStore {
    /** Gives the text that was saved last, or null. A compass never calls it while a save is under way. */
    public fun load(): String?

    /**
     * Keeps a text in the place of the one before. A compass calls this on a background thread, one call at a time: when the status is first
     * `Tracking`, then when the calibration has changed and 10 s have passed since the last save, when the last collector leaves, and at the
     * end of the readings. It saves only what it has learned from live samples, so neither the system's hard iron nor what [load] gave. A
     * change counts if it is more than 0.01 microtesla of hard iron or 0.0002 of soft iron: at rest both wander by less. The field strength
     * alone does not count, because it follows the noise of a device at rest.
     */
    public fun save(text: String)
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
    /**
     * The preferences named `org.magcomp` of an app.
     *
     * @param key names a situation that the app knows and that lasts, such as a phone that is folded or in a mount. Each has its own [Compass]
     *   with its own store, and all share one source. Default `calibration`
     */
    @JvmOverloads
    public constructor(context: Context, key: String = "calibration") : this(context.getSharedPreferences("org.magcomp", Context.MODE_PRIVATE), key)

    override fun load(): String? = preferences.getString(key, null)

    override fun save(text: String) {
        preferences.edit().putString(key, text).apply()
    }
}
