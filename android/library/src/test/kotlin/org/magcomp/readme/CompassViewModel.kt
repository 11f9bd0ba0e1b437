package org.magcomp.readme

import android.app.Application
import android.location.Location
import androidx.lifecycle.AndroidViewModel
import kotlin.math.roundToInt
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.catch
import kotlinx.coroutines.flow.map
import org.magcomp.Compass
import org.magcomp.CompassException
import org.magcomp.screenRotation
import org.magcomp.text

// what follows is in android/README.md; ReadmeTest compares them
class CompassViewModel(private val app: Application) : AndroidViewModel(app) {
    private val compass = Compass(app)

    /** Of the screen that collects it; its `Display.getRotation()` is asked with every reading, as upside down restarts no activity. */
    fun text(rotation: () -> Int): Flow<String> = compass.headings { screenRotation(rotation()) }.map { reading ->
        // null: the sentence says what is missing, also that the sensors have fallen silent
        val headingDeg = reading.headingDeg ?: return@map reading.text(app.resources)
        "${headingDeg.roundToInt() % 360}°, give or take ${reading.headingSigmaDeg?.roundToInt()}°"
    }.catch { emit((it as? CompassException ?: throw it).text(app.resources)) }

    /** For `reading.trueHeadingDeg`. The place needs a location permission, the sensors need none. */
    fun at(place: Location) = compass.setPlace(place)

    override fun onCleared() = compass.close()
}
