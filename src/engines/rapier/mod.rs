//! rapier worlds that mirror a scene.
