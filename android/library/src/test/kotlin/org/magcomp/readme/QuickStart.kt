package org.magcomp.readme

import android.app.Application
import androidx.lifecycle.AndroidViewModel
import kotlinx.coroutines.flow.map
import org.magcomp.Compass

// what follows is in README.md; ReadmeTest compares them
class HeadingViewModel(app: Application) : AndroidViewModel(app) {
    private val compass = Compass(app)

    val text = compass.headings().map { reading ->
        val headingDeg = reading.headingDeg ?: return@map reading.text(app.resources) // a sentence that says what is missing
        "$headingDeg deg +- ${reading.headingSigmaDeg}"
    }

    override fun onCleared() = compass.close()
}
