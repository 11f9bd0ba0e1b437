package org.magcomp

import android.app.Application
import android.content.Context
import android.content.ContextWrapper
import android.content.SharedPreferences
import android.content.pm.ApplicationInfo
import android.content.pm.PackageManager
import android.content.res.Resources

/** An app as [SensorManagerSource] and [PreferencesStore] see it. */
class FakeApp(
    private val sensors: FakeSensorManager,
    private val permissions: Set<String> = emptySet(),
    private val targetSdk: Int = 35,
) : Application() {
    val preferences = FakePreferences()

    private val resources = englishResources()

    override fun getApplicationContext(): Context = this

    override fun getResources(): Resources = resources

    override fun getSystemService(name: String): Any? = if (name == Context.SENSOR_SERVICE) sensors else null

    override fun getSharedPreferences(name: String, mode: Int): SharedPreferences =
        preferences.also { check(name == "org.magcomp" && mode == Context.MODE_PRIVATE) { "$name, mode $mode" } }

    override fun getApplicationInfo() = ApplicationInfo().apply { targetSdkVersion = targetSdk }

    override fun checkCallingOrSelfPermission(permission: String): Int =
        if (permission in permissions) PackageManager.PERMISSION_GRANTED else PackageManager.PERMISSION_DENIED
}

/** One of its activities: what it hands out keeps it, so the library must not ask it. */
class FakeActivity(app: FakeApp) : ContextWrapper(app) {
    override fun getApplicationContext(): Context = baseContext

    override fun getSystemService(name: String): Any? = error("the service keeps the activity")
}

/** As much of preferences as the store needs. What is put is there once it is applied. */
class FakePreferences : SharedPreferences, SharedPreferences.Editor {
    private val values = HashMap<String, String?>()
    private val put = HashMap<String, String?>()

    override fun getString(key: String, default: String?): String? = values[key] ?: default

    override fun edit(): SharedPreferences.Editor = this

    override fun putString(key: String, value: String?) = apply { put[key] = value }

    override fun apply() = values.putAll(put).also { put.clear() }

    override fun commit() = true.also { apply() }

    override fun getAll(): Map<String, *> = values

    override fun contains(key: String) = key in values

    override fun remove(key: String) = apply { values.remove(key) }

    override fun clear() = apply { values.clear() }

    override fun getStringSet(key: String, default: Set<String>?): Set<String>? = default

    override fun getInt(key: String, default: Int) = default

    override fun getLong(key: String, default: Long) = default

    override fun getFloat(key: String, default: Float) = default

    override fun getBoolean(key: String, default: Boolean) = default

    override fun putStringSet(key: String, values: Set<String>?) = this

    override fun putInt(key: String, value: Int) = this

    override fun putLong(key: String, value: Long) = this

    override fun putFloat(key: String, value: Float) = this

    override fun putBoolean(key: String, value: Boolean) = this

    override fun registerOnSharedPreferenceChangeListener(l: SharedPreferences.OnSharedPreferenceChangeListener) = Unit

    override fun unregisterOnSharedPreferenceChangeListener(l: SharedPreferences.OnSharedPreferenceChangeListener) = Unit
}
