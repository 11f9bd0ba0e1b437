package org.magcomp.readme

import android.content.Context
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.map
import org.magcomp.Compass

// what follows is in README.md; ReadmeTest compares them
fun headings(context: Context): Flow<String> = Compass(context).headings().map { reading ->
    val headingDeg = reading.headingDeg ?: return@map reading.text(context.resources) // a sentence that says what is missing
    "$headingDeg deg +- ${reading.headingSigmaDeg}"
}
