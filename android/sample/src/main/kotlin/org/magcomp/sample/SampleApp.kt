package org.magcomp.sample

import android.app.Application
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.SupervisorJob
import org.magcomp.Compass

/** Keeps the one compass: a screen that is turned is another activity, and goes on with it. */
class SampleApp : Application() {
    val compass: Compass by lazy { Compass(this) }

    /** Goes on when a screen is turned or gone. */
    val recording: Recording by lazy { Recording(compass, getExternalFilesDir(null), CoroutineScope(Dispatchers.Main + SupervisorJob()), resources) }
}
