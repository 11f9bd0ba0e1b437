package org.magcomp.sample

import androidx.compose.foundation.background
import androidx.compose.foundation.clickable
import androidx.compose.foundation.isSystemInDarkTheme
import androidx.compose.foundation.layout.Arrangement
import androidx.compose.foundation.layout.Column
import androidx.compose.foundation.layout.fillMaxSize
import androidx.compose.foundation.layout.fillMaxWidth
import androidx.compose.foundation.layout.padding
import androidx.compose.foundation.layout.size
import androidx.compose.foundation.rememberScrollState
import androidx.compose.foundation.selection.toggleable
import androidx.compose.foundation.shape.RoundedCornerShape
import androidx.compose.foundation.text.BasicText
import androidx.compose.foundation.verticalScroll
import androidx.compose.runtime.Composable
import androidx.compose.ui.Alignment
import androidx.compose.ui.Modifier
import androidx.compose.ui.graphics.Color
import androidx.compose.ui.semantics.Role
import androidx.compose.ui.text.TextStyle
import androidx.compose.ui.text.style.TextAlign
import androidx.compose.ui.unit.TextUnit
import androidx.compose.ui.unit.dp
import androidx.compose.ui.unit.sp
import org.magcomp.compose.CompassRose
import org.magcomp.compose.DirectionSphere
import org.magcomp.compose.RoseColors
import org.magcomp.compose.SphereColors

private class Ink(isDark: Boolean) {
    val paper = if (isDark) Color(0xff111417) else Color(0xfffafafa)
    val text = if (isDark) Color(0xffe6e6e6) else Color(0xff1b1b1b)
    val faint = if (isDark) Color(0xff5b6167) else Color(0xffb4b8bc)
    val north = if (isDark) Color(0xffff6b5e) else Color(0xffc62828)
    val missing = if (isDark) Color(0xff7bc67e) else Color(0xff2e7d32)
    val banner = if (isDark) Color(0xff6b4300) else Color(0xffffe0a8)
}

/** Whether something is on, in words, and what sets it. */
class ScreenSwitch(val isOn: Boolean, val text: String, val onChange: (Boolean) -> Unit)

/** Something that can be done, in words. */
class ScreenButton(val text: String, val onClick: () -> Unit)

/** The screen of a state; [letters] are those of north, east, south and west, [insets] keep clear of the system's bars. It decides nothing. */
@Composable
fun CompassScreen(
    state: ScreenState,
    letters: List<String>,
    isDark: Boolean = isSystemInDarkTheme(),
    insets: Modifier = Modifier,
    switches: List<ScreenSwitch> = emptyList(),
    buttons: List<ScreenButton> = emptyList(),
) {
    val ink = Ink(isDark)
    Column(
        Modifier.fillMaxSize().background(ink.paper).then(insets).verticalScroll(rememberScrollState()).padding(24.dp),
        verticalArrangement = Arrangement.spacedBy(8.dp),
        horizontalAlignment = Alignment.CenterHorizontally,
    ) {
        state.banner?.let { Words(it, ink, modifier = Modifier.fillMaxWidth().background(ink.banner, RoundedCornerShape(8.dp)).padding(12.dp)) }
        CompassRose(state.roseDeg, state.sigmaDeg, state.spoken, RoseColors(ink.north, ink.text, ink.faint), Modifier.size(260.dp), letters)
        Words(state.heading, ink, size = 36.sp)
        listOfNotNull(state.trueHeading, state.systemHeading, state.field, state.status, state.help, state.event, state.seen, state.guidance)
            .forEach { Words(it, ink) }
        switches.forEach { Words(it.text, ink, modifier = Modifier.toggleable(it.isOn, role = Role.Switch, onValueChange = it.onChange).padding(12.dp)) }
        buttons.forEach { Words(it.text, ink, modifier = Modifier.clickable(role = Role.Button, onClick = it.onClick).padding(12.dp)) }
        if (state.unseen.isNotEmpty()) {
            DirectionSphere(state.unseen, state.pointing, state.next, SphereColors(ink.missing, ink.text, ink.faint), Modifier.size(120.dp))
        }
    }
}

@Composable
private fun Words(text: String, ink: Ink, modifier: Modifier = Modifier, size: TextUnit = 16.sp) =
    BasicText(text, modifier, TextStyle(color = ink.text, fontSize = size, textAlign = TextAlign.Center))
