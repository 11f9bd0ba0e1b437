package org.magcomp

import android.content.Context
import android.content.SharedPreferences

/**
 * Where a calibration is kept from one launch to the next. The text is JSON with its own
 * version, source, date and covariance; a store need not look into it. Of a text that is damaged or of a newer version nothing is taken
 * over, and it is told in [CompensatedReading.storeError]. So is an error of the store, which harms no reading; the next save
 * tries again.
 */
public interface CalibrationStore {
    /** The text that was saved last, or null. Never called before a save that is under way has returned. */
    public fun load(): String?

    /**
     * Keeps a text in the place of the one before. Never called while nothing was learned from live samples, so neither the system's
     * hard iron nor what [load] gave is ever saved as learned. Called on a background thread, one call at a time: when the
     * status is first `Tracking`, then when the calibration has changed and 10 s have passed since the save before,
     * when the last collector leaves, and at the end of the readings. A change of hard iron by more than 0.01 microtesla or of soft iron
     * by more than 0.0002 counts: at rest both wander by less. A change of the field strength alone does not, because it follows the noise
     * of a device at rest. Never called when [load] or the save before has kept the same.
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
     * @param key one for each situation that the app knows and that lasts, such as a phone that is folded or in a mount: a [Compass] with its
     *   own store for each, of one source. Left out: `calibration`
     */
    @JvmOverloads
    public constructor(context: Context, key: String = "calibration") : this(context.getSharedPreferences("org.magcomp", Context.MODE_PRIVATE), key)

    override fun load(): String? = preferences.getString(key, null)

    override fun save(text: String) {
        preferences.edit().putString(key, text).apply()
    }
}
