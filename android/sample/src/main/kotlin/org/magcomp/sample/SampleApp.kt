package org.magcomp.sample

import android.app.Application
import org.magcomp.Compass

/** Keeps the one compass: a screen that is turned is another activity, and goes on with it. */
class SampleApp : Application() {
    val compass: Compass by lazy { Compass(this) }
}
