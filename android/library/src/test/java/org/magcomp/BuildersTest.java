package org.magcomp;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertNotNull;

import java.lang.reflect.Method;
import java.util.Arrays;
import java.util.HashSet;
import java.util.List;
import java.util.Set;
import java.util.stream.Collectors;
import org.junit.jupiter.api.Test;
import org.magcomp.core.*;

/** Configs as Java makes them. */
class BuildersTest {
    @Test
    void whatIsSetIsInTheConfig() throws MagcompException {
        CompensationConfig config = new CompensationConfigBuilder()
            .method(CompensationMethod.WINDOWED)
            .heading(new HeadingConfigBuilder().axis(ReferenceAxis.CAMERA).declinationDeg(3.0).build())
            .build();
        assertEquals(CompensationMethod.WINDOWED, config.getMethod());
        assertEquals(ReferenceAxis.CAMERA, config.getHeading().getAxis());
        assertEquals(3.0, config.getHeading().getDeclinationDeg());
        assertEquals(new CompensationConfig(), new CompensationConfigBuilder().rangeUt(5.0).rangeUt(null).build());
        try (Compensator compensator = new Compensator(config)) {
            assertEquals(config, compensator.getConfig());
        }
    }

    @Test
    void everyFieldHasItsSetter() throws Exception {
        Object[][] pairs = {
            {new CompensationConfigBuilder(), CompensationConfig.class},
            {new HeadingConfigBuilder(), HeadingConfig.class},
        };
        for (Object[] pair : pairs) {
            Class<?> built = (Class<?>) pair[1];
            Set<String> fields = Arrays.stream(built.getDeclaredFields())
                .map(field -> field.getName()).filter(name -> !name.equals("Companion")).collect(Collectors.toSet());
            List<Method> setters = Arrays.stream(pair[0].getClass().getMethods())
                .filter(method -> method.getReturnType() == pair[0].getClass()).collect(Collectors.toList());
            assertEquals(fields, new HashSet<>(setters.stream().map(Method::getName).collect(Collectors.toList())));
            for (Method setter : setters) {
                Object value = example(setter.getParameterTypes()[0]);
                setter.invoke(pair[0], value);
                Object config = pair[0].getClass().getMethod("build").invoke(pair[0]);
                String name = setter.getName();
                String getter = "get" + name.substring(0, 1).toUpperCase() + name.substring(1);
                assertEquals(value, built.getMethod(getter).invoke(config), name);
            }
        }
    }

    private static Object example(Class<?> type) {
        if (type == Double.class) return 1.5;
        if (type == Integer.class) return 7;
        if (type == Boolean.class) return true;
        if (type == HeadingConfig.class) return new HeadingConfig();
        if (type == WindowedConfig.class) return new WindowedConfig();
        if (type == MagnetometerCalibration.class) return new MagnetometerCalibration(new SoftIron(1, 1, 1, 0, 0, 0), new DeviceVector(1, 2, 3), 50);
        assertNotNull(type.getEnumConstants(), type.getName());
        return type.getEnumConstants()[1];
    }
}
