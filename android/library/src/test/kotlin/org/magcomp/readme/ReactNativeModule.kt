package org.magcomp.readme

import com.facebook.react.bridge.Arguments
import com.facebook.react.bridge.ReactApplicationContext
import com.facebook.react.bridge.ReactContextBaseJavaModule
import com.facebook.react.bridge.ReactMethod
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.Job
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.magcomp.Compass

// what follows is in docs/FRAMEWORKS.md; ReadmeTest compares them
class MagcompModule(private val context: ReactApplicationContext) : ReactContextBaseJavaModule(context) {
    private val scope = CoroutineScope(SupervisorJob() + Dispatchers.Default)
    private val compass = Compass(context)
    private var listeners = 0
    private var running: Job? = null
    override fun getName() = "Magcomp"

    @ReactMethod fun addListener(event: String) {
        if (listeners++ == 0) running = scope.launch {
            told(compass, context.resources).collect { context.emitDeviceEvent("heading", Arguments.makeNativeMap(it)) }
        }
    }

    @ReactMethod fun removeListeners(count: Int) {
        listeners = maxOf(0, listeners - count)
        if (listeners == 0) running?.cancel()
    }

    override fun invalidate() { scope.cancel(); compass.close() }
}
