package com.facebook.react.bridge

import android.content.Context
import android.content.ContextWrapper

// As much of React Native as docs/FRAMEWORKS.md uses, by its sources: they say nothing of what the real one does.

class ReactApplicationContext(context: Context) : ContextWrapper(context) {
    val emitted = mutableListOf<Pair<String, Any?>>()

    fun emitDeviceEvent(name: String, data: Any?) {
        synchronized(emitted) { emitted += name to data }
    }
}

abstract class ReactContextBaseJavaModule(context: ReactApplicationContext) {
    abstract fun getName(): String

    open fun invalidate() {}
}

annotation class ReactMethod

object Arguments {
    fun makeNativeMap(map: Map<String, Any?>?): Map<String, Any?>? = map
}
