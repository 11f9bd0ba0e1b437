@file:JvmName("LifecycleKt")

package androidx.lifecycle

import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.coroutineScope
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.collectLatest

// Stand-ins of AndroidX, which is in Google's Maven alone: as much as rememberCompass needs. What is published is built with Gradle, without them.

class Lifecycle {
    enum class State { CREATED, STARTED }

    val state = MutableStateFlow(State.CREATED)
}

interface LifecycleOwner {
    val lifecycle: Lifecycle
}

suspend fun LifecycleOwner.repeatOnLifecycle(state: Lifecycle.State, block: suspend kotlinx.coroutines.CoroutineScope.() -> Unit) {
    lifecycle.state.collectLatest { if (it >= state) coroutineScope(block) else awaitCancellation() }
}
