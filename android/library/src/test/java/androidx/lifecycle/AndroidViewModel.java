package androidx.lifecycle;

import android.app.Application;

/** Stands in for AndroidX's, which is in Google's Maven alone: as much as the README's view model needs to compile and run. */
public class AndroidViewModel {
    private final Application application;

    public AndroidViewModel(Application application) {
        this.application = application;
    }

    public <T extends Application> T getApplication() {
        @SuppressWarnings("unchecked")
        T app = (T) application;
        return app;
    }

    protected void onCleared() { }
}
