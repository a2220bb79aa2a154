"""How many candies to put into the cup: from what the object holds and what somebody asks for."""
