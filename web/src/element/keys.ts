// Which keys does the page hear, and what do they do?
//
// Made of crates/core/src/view/keys.rs by `cargo xtask bless keys`.

/** The rows of the table, as they are listed. */
export const KEYS = [
  { shown: "H  ?", says: "cycle: help, statistics, off", needs: "nothing", keys: [
    {"key":"h","does":"overlay"},
    {"key":"?","does":"overlay"},
  ] },
  { shown: "space", says: "play, pause", needs: "frames", keys: [
    {"key":" ","does":"pause"},
  ] },
  { shown: ",  .", says: "frame back, forward", needs: "frames", keys: [
    {"key":",","does":"step","by":-1},
    {"key":".","does":"step","by":1},
  ] },
  { shown: "[  ]", says: "5 s back, forward", needs: "frames", keys: [
    {"key":"[","does":"skip","by":-5.0},
    {"key":"]","does":"skip","by":5.0},
  ] },
  { shown: "Shift Left  Shift Right", says: "5 s back, forward", needs: "frames", keys: [
    {"key":"Shift+ArrowLeft","does":"skip","by":-5.0},
    {"key":"Shift+ArrowRight","does":"skip","by":5.0},
  ] },
  { shown: "Home  End", says: "first, last frame", needs: "frames", keys: [
    {"key":"Home","does":"first"},
    {"key":"End","does":"last"},
  ] },
  { shown: "Left  Right", says: "look around, move", needs: "nothing", keys: [
    {"key":"ArrowLeft","does":"move","by":[0.0625,0.0]},
    {"key":"ArrowRight","does":"move","by":[-0.0625,0.0]},
  ] },
  { shown: "Up  Down", says: "look up and down, move", needs: "nothing", keys: [
    {"key":"ArrowUp","does":"move","by":[0.0,0.0625]},
    {"key":"ArrowDown","does":"move","by":[0.0,-0.0625]},
  ] },
  { shown: "+", says: "closer", needs: "nothing", keys: [
    {"key":"+","does":"zoom","by":1.25},
    {"key":"=","does":"zoom","by":1.25},
  ] },
  { shown: "-", says: "farther", needs: "nothing", keys: [
    {"key":"-","does":"zoom","by":0.8},
    {"key":"_","does":"zoom","by":0.8},
  ] },
  { shown: "0", says: "whole picture, front of a sphere, start", needs: "nothing", keys: [
    {"key":"0","does":"reset"},
  ] },
  { shown: "P  Shift P", says: "next policy, the one before", needs: "nothing", keys: [
    {"key":"p","does":"policy","by":1},
    {"key":"Shift+p","does":"policy","by":-1},
  ] },
  { shown: "J  Shift J", says: "higher, lower target score (JOD)", needs: "nothing", keys: [
    {"key":"j","does":"target","by":1},
    {"key":"Shift+j","does":"target","by":-1},
  ] },
  { shown: "M", says: "sound", needs: "heard", keys: [
    {"key":"m","does":"sound"},
  ] },
  { shown: "L", says: "tiles coloured by level, red the finest", needs: "atlas", keys: [
    {"key":"l","does":"levels"},
  ] },
  { shown: "O", says: "figures", needs: "nothing", keys: [
    {"key":"o","does":"figures"},
  ] },
  { shown: "F", says: "full screen", needs: "nothing", keys: [
    {"key":"f","does":"fullScreen"},
  ] },
  { shown: "W  S", says: "scenes: fly ahead, back; Shift: faster", needs: "scene", keys: [
    {"key":"w","does":"fly","by":[0.0,0.0,1.0]},
    {"key":"s","does":"fly","by":[0.0,0.0,-1.0]},
  ] },
  { shown: "A  D", says: "scenes: fly left, right", needs: "scene", keys: [
    {"key":"a","does":"fly","by":[-1.0,0.0,0.0]},
    {"key":"d","does":"fly","by":[1.0,0.0,0.0]},
  ] },
  { shown: "E  C", says: "scenes: fly up, down", needs: "scene", keys: [
    {"key":"e","does":"fly","by":[0.0,1.0,0.0]},
    {"key":"c","does":"fly","by":[0.0,-1.0,0.0]},
  ] },
  { shown: "Home", says: "scenes: back to the start", needs: "scene", keys: [
    {"key":"Home","does":"reset"},
  ] },
  { shown: "L", says: "scenes: coloured by level, red the finest", needs: "scene", keys: [
    {"key":"l","does":"levels"},
  ] },
] as const;
