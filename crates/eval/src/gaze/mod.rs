//! How true are detectors and predictors of gaze, against recordings of real eyes?
