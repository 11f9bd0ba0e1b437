package androidx.compose.ui.platform

import android.view.View
import androidx.compose.runtime.compositionLocalOf

val LocalView = compositionLocalOf<View> { error("none is given") }
