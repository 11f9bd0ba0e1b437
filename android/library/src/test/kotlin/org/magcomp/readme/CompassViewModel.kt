package org.magcomp.readme

import android.app.Application
import android.location.Location
import android.view.Display
import androidx.lifecycle.AndroidViewModel
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.catch
import kotlinx.coroutines.flow.map
import org.magcomp.Compass
import org.magcomp.screenRotation
import org.magcomp.text

// what follows is in android/README.md; ReadmeTest compares them
class CompassViewModel(app: Application) : AndroidViewModel(app) {
    private val compass = Compass(app)

    val text: Flow<String> = compass.readings().map { (reading) ->
        val heading = reading.heading ?: return@map reading.status.text(app.resources)
        "${heading.headingDeg} deg, give or take ${heading.headingSigmaDeg}"
    }.catch { emit(it.message ?: "$it") } // no magnetometer, for instance

    /** For `heading.trueHeadingDeg`. The place needs a location permission, the sensors need none. */
    fun at(place: Location) = compass.setPlace(place)

    /** Wherever the screen turned (`DisplayListener`): upside down restarts no activity. */
    fun turned(display: Display) {
        compass.screenRotation = screenRotation(display.rotation)
    }
}
