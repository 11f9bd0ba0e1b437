package androidx.lifecycle.compose

import androidx.compose.runtime.compositionLocalOf
import androidx.lifecycle.LifecycleOwner

val LocalLifecycleOwner = compositionLocalOf<LifecycleOwner> { error("none is given") }
