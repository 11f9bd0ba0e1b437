package org.magcomp.readme

import android.content.Context
import io.flutter.plugin.common.EventChannel
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Job
import kotlinx.coroutines.launch
import org.magcomp.Compass

// what follows is in docs/FRAMEWORKS.md; ReadmeTest compares them
/** The sink wants the main thread: `scope` is `MainScope()`. */
class HeadingHandler(private val context: Context, private val scope: CoroutineScope) : EventChannel.StreamHandler {
    private val compass = Compass(context)
    private var running: Job? = null

    override fun onListen(arguments: Any?, events: EventChannel.EventSink) {
        running = scope.launch { told(compass, context.resources).collect(events::success) }
    }

    override fun onCancel(arguments: Any?) { running?.cancel() }
}
