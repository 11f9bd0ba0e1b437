package org.magcomp.sample

import android.Manifest
import android.location.Location
import android.location.LocationListener
import android.os.Bundle
import org.magcomp.Compass
import org.magcomp.HELD_AHEAD
import org.magcomp.core.MagcompException

/** Each fix of who walks and holds the phone ahead: its place gives true north, its course helps. */
class CourseHelp(private val compass: Compass) : LocationListener {
    override fun onLocationChanged(location: Location) {
        try {
            compass.setPlace(location)
            compass.aid(location, HELD_AHEAD)
        } catch (_: MagcompException) {
            // a fix that can't be, of a provider that plays: the next may be
        }
    }

    // before Android 11 these have no body of their own, and Android calls them
    override fun onProviderEnabled(provider: String) = Unit

    override fun onProviderDisabled(provider: String) = Unit

    @Deprecated("Android calls it before version 10")
    override fun onStatusChanged(provider: String?, status: Int, extras: Bundle?) = Unit

    companion object {
        /** Android 12 and newer want both in one request, or ignore it. */
        val PERMISSIONS = arrayOf(Manifest.permission.ACCESS_FINE_LOCATION, Manifest.permission.ACCESS_COARSE_LOCATION)

        /** Whether what the user granted is enough: an approximate place has no course. */
        fun isAllowed(granted: Map<String, Boolean>): Boolean = granted[Manifest.permission.ACCESS_FINE_LOCATION] == true
    }
}
